import math
from uuid import UUID

import pytest

from labeler.carla.vehicles import VehicleTruth, category_of
from labeler.simulation.truth import Target
from tests.labeler.carla.fake_carla import Blueprints, Client, Location, Rotation, Server, Transform

pytest.importorskip("embreex", reason="needs embreex, of the extras `carla` and `simulation`")

RECORDING = UUID("0c5d7b8e-0000-4000-8000-000000000001")


@pytest.mark.parametrize(
    ("type_id", "attributes", "category"),
    [
        ("vehicle.tesla.model3", {"base_type": "car", "number_of_wheels": "4"}, "car"),
        ("vehicle.mercedes.sprinter", {"base_type": "van", "number_of_wheels": "4"}, "car"),  # a van is a car in COCO
        ("vehicle.carlamotors.carlacola", {"number_of_wheels": "4"}, "truck"),  # before 0.9.14: no base_type
        ("vehicle.carlamotors.carlacola", {"base_type": "truck", "number_of_wheels": "4"}, "truck"),
        ("vehicle.mitsubishi.fusorosa", {"base_type": "bus", "number_of_wheels": "4"}, "bus"),
        ("vehicle.mitsubishi.fusorosa", {"number_of_wheels": "4"}, "bus"),
        ("vehicle.audi.tt", {"number_of_wheels": "4"}, "car"),
        ("vehicle.yamaha.yzf", {"number_of_wheels": "2"}, "motorcycle"),
        ("vehicle.gazelle.omafiets", {"number_of_wheels": "2"}, None),  # a bicycle
        ("vehicle.new.bike", {"base_type": "bicycle", "number_of_wheels": "2"}, None),
    ],
)
def test_categories(type_id: str, attributes: dict[str, str], category: str | None) -> None:
    assert category_of(type_id, attributes) == category


def targets_beside(ego: Transform, other: Transform, model: str = "vehicle.tesla.model3") -> list[Target]:
    server, library = Server(), Blueprints()
    ego_actor = server.spawn(library.find("vehicle.tesla.model3"), ego)
    server.spawn(library.find(model), other)
    server.tick()
    world = Client(server).get_world()
    return VehicleTruth(ego_actor.id, RECORDING).targets(world, world.get_snapshot())


def test_a_vehicle_ahead_and_to_the_right() -> None:
    """The ego car faces CARLA's y. 10 m ahead is +10 in y; 4 m to its right is -4 in x."""
    ego = Transform(Location(100, 50, 0), Rotation(yaw=90))
    (target,) = targets_beside(ego, Transform(Location(96, 60, 0), Rotation(yaw=180)))
    # the box's middle is 0.1 m before the actor's origin, which looks to our right: 0.1 m farther right; bottom 2 cm up
    assert target.ego_SE3_body[:3, 3] == pytest.approx([10.0, -4.1, 0.02])
    assert math.degrees(math.atan2(target.ego_SE3_body[1, 0], target.ego_SE3_body[0, 0])) == pytest.approx(-90)
    assert target.size_m == (4.8, 2.2, 1.5)
    assert target.category == "car"


def test_an_ego_car_that_climbs() -> None:
    """With the nose 30 degrees up, what is level ahead lies below the car's own axis."""
    (target,) = targets_beside(Transform(Location(), Rotation(pitch=30)), Transform(Location(20, 0, 0)))
    along, up = 20.1 * math.cos(math.radians(30)), -20.1 * math.sin(math.radians(30))
    rise_along, rise_up = 0.02 * math.sin(math.radians(30)), 0.02 * math.cos(math.radians(30))
    assert target.ego_SE3_body[:3, 3] == pytest.approx([along + rise_along, 0.0, up + rise_up])


def test_an_actor_keeps_its_uuid() -> None:
    here, there = Transform(Location(20, 0, 0)), Transform(Location(30, 5, 0))
    (first,), (second,) = targets_beside(Transform(), here), targets_beside(Transform(), there)
    assert first.track_uuid == second.track_uuid
    assert UUID(first.track_uuid).version == 5


def test_the_ego_car_is_no_target() -> None:
    server = Server()
    ego = server.spawn(Blueprints().find("vehicle.tesla.model3"), Transform())
    server.tick()
    world = Client(server).get_world()
    assert VehicleTruth(ego.id, RECORDING).targets(world, world.get_snapshot()) == []


def test_an_actor_that_came_after_the_frame_is_left_out() -> None:
    server, library = Server(), Blueprints()
    ego = server.spawn(library.find("vehicle.tesla.model3"), Transform())
    server.tick()
    server.spawn(library.find("vehicle.tesla.model3"), Transform(Location(20, 0, 0)))
    world = Client(server).get_world()
    assert VehicleTruth(ego.id, RECORDING).targets(world, world.get_snapshot()) == []
