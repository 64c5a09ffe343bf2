"""The fleet: sizes, closed bodies, levels of detail, categories."""

from collections import Counter

import numpy as np
import pytest

from labeler.simulation.car_body import DETAILS, BodyLayers, body_mesh
from labeler.simulation.car_shapes import CAR_SHAPES, CarShape
from labeler.simulation.dimensions import LANE_WIDTH_M, SLOT_LENGTH_M, SLOT_WIDTH_M
from labeler.simulation.materials import Material
from labeler.simulation.rounded_box import BoxLayers, rounded_box
from labeler.simulation.textures import TextureSet
from labeler.simulation.vehicles import VehicleModel, fleet
from labeler.simulation.wheels import wheel
from tests.labeler.simulation.mesh_checks import open_edges, volume_m3


@pytest.fixture(scope="module")
def models() -> tuple[VehicleModel, ...]:
    return fleet(3)


def test_sizes_are_those_of_the_bounding_boxes_on_the_ground(models: tuple[VehicleModel, ...]) -> None:
    for model in models:
        low, high = model.mesh.bounds_m
        half_length_m, half_width_m = model.size_m[0] / 2, model.size_m[1] / 2
        np.testing.assert_allclose(low, [-half_length_m, -half_width_m, 0.0], atol=1e-4, err_msg=model.name)
        np.testing.assert_allclose(high, [half_length_m, half_width_m, model.size_m[2]], atol=1e-4, err_msg=model.name)


def test_every_level_of_detail_fills_the_same_box_with_fewer_triangles(models: tuple[VehicleModel, ...]) -> None:
    for model in models:
        fine_low, fine_high = model.mesh.bounds_m
        assert len(model.details) == DETAILS
        for finer, coarser in zip(model.details[:-1], model.details[1:], strict=True):
            assert len(coarser.faces) < len(finer.faces)
            low, high = coarser.bounds_m
            np.testing.assert_allclose(low, fine_low, atol=0.03, err_msg=model.name)
            np.testing.assert_allclose(high, fine_high, atol=0.03, err_msg=model.name)


def test_the_fleet_has_every_kind(models: tuple[VehicleModel, ...]) -> None:
    kinds = Counter(model.category for model in models)

    assert kinds == {"car": 14, "truck": 2 + 3, "bus": 3, "motorcycle": 4}
    assert len({model.name for model in models}) == len(models)
    assert [model.name for model in models if model.rider] == ["motorcycle-ridden", "scooter-ridden"]
    assert all(model.parks != model.rider for model in models)


def test_vehicles_fit_their_lanes_and_cars_their_slots(models: tuple[VehicleModel, ...]) -> None:
    for model in models:
        assert model.size_m[1] < LANE_WIDTH_M - 0.3
        assert model.rear_axle_m < 0 < model.front_axle_m
        if model.category == "car":
            assert model.size_m[0] < SLOT_LENGTH_M
            assert model.size_m[1] <= SLOT_WIDTH_M


def test_collision_meshes_know_their_materials(models: tuple[VehicleModel, ...]) -> None:
    for model in models:
        materials = set(model.collision_mesh.material.tolist())
        assert {Material.RUBBER, Material.PAINT} <= materials


def test_the_same_seed_gives_the_same_fleet_and_pictures() -> None:
    textures = [TextureSet(), TextureSet()]
    fleets = [fleet(8, layers) for layers in textures]

    assert [model.size_m for model in fleets[0]] == [model.size_m for model in fleets[1]]
    assert all(a.mesh.vertices.tobytes() == b.mesh.vertices.tobytes() for a, b in zip(*fleets, strict=True))
    assert len(textures[0]) == len(textures[1]) > 60
    assert all(np.array_equal(a, b) for a, b in zip(textures[0].color, textures[1].color, strict=True))


@pytest.mark.parametrize("shape", CAR_SHAPES, ids=lambda shape: shape.style)
@pytest.mark.parametrize("detail", range(DETAILS))
def test_car_bodies_are_closed_and_turned_outwards(shape: CarShape, detail: int) -> None:
    body = body_mesh(shape, BodyLayers(0, 1, 2, 3, 4), detail)

    assert open_edges(body) == 0
    # a car fills between a third and nine tenths of its bounding box
    share = volume_m3(body) / (shape.length_m * shape.width_m * shape.height_m)
    assert 0.33 < share < 0.9


def test_a_rounded_box_is_closed_and_keeps_its_size() -> None:
    body = rounded_box((-2, -1, 0.5), (2, 1, 2.5), 0.2, BoxLayers(0, 1, 2, 3, 4), steps=6)

    assert open_edges(body) == 0
    np.testing.assert_allclose(body.bounds_m, [(-2, -1, 0.5), (2, 1, 2.5)], atol=1e-6)
    assert 0.95 * 16 < volume_m3(body) < 16


def test_a_wheel_is_closed_round_and_as_wide_as_said() -> None:
    one = wheel(0.4, 0.2, 0, sides=24)

    assert open_edges(one) == 0
    np.testing.assert_allclose(one.bounds_m, [(-0.4, -0.1, -0.4), (0.4, 0.1, 0.4)], atol=1e-6)
    assert 0.8 * np.pi * 0.16 * 0.2 < volume_m3(one) < np.pi * 0.16 * 0.2
