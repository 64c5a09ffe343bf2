"""A small CARLA client with a world behind it: as much of its interface as a recording uses, in left-handed frames.

Sensors call back in threads of their own, in shuffled order, and repeat an old reading before the new one. Vehicles go
straight on at their own speed. What a test wants to go wrong is set on the :class:`Server`.
"""

import random
import threading
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from tests.labeler.carla.fake_scene import camera_rays, cast, left_handed_matrix, lidar_rays

CAR_TAG, CAR_TAG_UNTIL_0_9_13, GROUND_TAG = 14, 10, 1
ENGINE_NUMBER = 300
"""What pixels of the ground show as their instance: a number of the engine's that may be an actor's too."""


@dataclass
class Location:
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


@dataclass
class Rotation:
    pitch: float = 0.0
    yaw: float = 0.0
    roll: float = 0.0


@dataclass
class Transform:
    location: Location = field(default_factory=Location)
    rotation: Rotation = field(default_factory=Rotation)

    def get_matrix(self) -> np.ndarray:
        place, turn = self.location, self.rotation
        return left_handed_matrix(place.x, place.y, place.z, turn.roll, turn.pitch, turn.yaw)


@dataclass
class BoundingBox:
    location: Location
    extent: Location
    rotation: Rotation = field(default_factory=Rotation)


@dataclass(frozen=True)
class Settings:
    synchronous_mode: bool = False
    fixed_delta_seconds: float | None = None
    no_rendering_mode: bool = False
    substepping: bool = True
    max_substeps: int = 10
    max_substep_delta_time: float = 0.01


@dataclass(frozen=True)
class Image:
    width: int
    height: int
    raw_data: memoryview
    frame: int = 0


class Attribute(str):
    recommended_values = ("255,0,0", "0,0,255")


class Blueprint:
    def __init__(self, name: str, attributes: dict[str, str]) -> None:
        self.id, self.attributes = name, attributes

    def has_attribute(self, name: str) -> bool:
        return name in self.attributes

    def get_attribute(self, name: str) -> Attribute:
        return Attribute(self.attributes[name])

    def set_attribute(self, name: str, value: str) -> None:
        if name not in self.attributes:
            raise IndexError(f"blueprint '{self.id}' has no attribute '{name}'")
        assert isinstance(value, str), "CARLA takes texts only"
        self.attributes[name] = value


CAMERA = {"image_size_x": "800", "image_size_y": "600", "fov": "90.0", "sensor_tick": "0.0"}
LIDAR = {
    "channels": "32",
    "range": "10.0",
    "points_per_second": "56000",
    "rotation_frequency": "10.0",
    "upper_fov": "10.0",
    "lower_fov": "-30.0",
    "noise_stddev": "0.0",
    "dropoff_general_rate": "0.45",
    "sensor_tick": "0.0",
}
CAR = {"number_of_wheels": "4", "role_name": "", "color": "0,0,0"}
BLUEPRINTS = {
    "sensor.camera.rgb": CAMERA | {"motion_blur_intensity": "0.45", "lens_flare_intensity": "0.1"},
    "sensor.camera.depth": CAMERA,
    "sensor.camera.semantic_segmentation": CAMERA,
    "sensor.camera.instance_segmentation": CAMERA,
    "sensor.lidar.ray_cast": LIDAR,
    "vehicle.tesla.model3": CAR | {"base_type": "car"},
    "vehicle.mitsubishi.fusorosa": CAR | {"base_type": "bus"},
    "vehicle.vespa.zx125": CAR | {"number_of_wheels": "2", "base_type": "motorcycle"},
}
HALF_SIDES = {"vehicle.tesla.model3": (2.4, 1.1, 0.75), "vehicle.mitsubishi.fusorosa": (5.1, 1.9, 2.1)}


class Actor:
    def __init__(self, server: "Server", number: int, blueprint: Blueprint, place: Transform, parent: Any) -> None:
        self._server, self.id, self.type_id, self.attributes = server, number, blueprint.id, dict(blueprint.attributes)
        self.place, self.parent, self.is_alive = place, parent, True
        half = HALF_SIDES.get(blueprint.id, (1.0, 0.4, 0.6))
        self.bounding_box = BoundingBox(Location(0.1, 0.0, half[2] + 0.02), Location(*half))
        self.autopilot: int | None = None
        self.listener: Callable[[Any], None] | None = None
        self.last_reading: Any = None

    def set_autopilot(self, enabled: bool, port: int) -> None:
        self.autopilot = port if enabled else None

    def listen(self, listener: Callable[[Any], None]) -> None:
        self.listener = listener

    def stop(self) -> None:
        self.listener = None

    def destroy(self) -> bool:
        self._server.call(f"destroy {self.type_id}")
        self._server.actors.pop(self.id, None)
        self.is_alive = False
        return True


class Actors(list[Any]):
    def filter(self, pattern: str) -> list[Any]:
        return [one for one in self if getattr(one, "type_id", None) is None or one.type_id.startswith(pattern[:-1])]


class Blueprints:
    def find(self, name: str) -> Blueprint:
        return Blueprint(name, dict(BLUEPRINTS[name]))

    def filter(self, pattern: str) -> list[Blueprint]:
        return [self.find(name) for name in BLUEPRINTS if name.startswith(pattern[:-1])]


class Server:
    """The simulator: its world's state, what has been asked of it, and what is to go wrong."""

    def __init__(self, version: str = "0.9.16", towns: tuple[str, ...] = ("Town01", "Town10HD")) -> None:
        self.version, self.client_version, self.towns, self.town = version, version, towns, "Town10HD"
        self.settings, self.weather, self.frame = Settings(), "storm", 40
        self.actors: dict[int, Actor] = {}
        self.spawn_points = [Transform(Location(10.0 * row, -20.0 * row, 0.0), Rotation(yaw=0.0)) for row in range(3)]
        self.speed_mps = 2.0
        self.hidden_scenery: set[int] = set()
        self.traffic_synchronous = False
        self.silent_sensor = ""
        self.fail_at_frame: int | None = None
        self.error: BaseException = RuntimeError("time-out of 60000ms while waiting for the simulator")
        self.broken_calls: tuple[str, ...] = ()
        self._next_actor, self._threads = 90, list[threading.Thread]()
        self._shuffle = random.Random(4)
        self.places: dict[int, Transform] = {}

    def call(self, name: str) -> None:
        if name in self.broken_calls:
            raise RuntimeError("rpc::timeout")

    def spawn(self, blueprint: Blueprint, place: Transform, parent: Any = None) -> Actor:
        self._next_actor += 1
        actor = Actor(self, self._next_actor, blueprint, place, parent)
        self.actors[actor.id] = actor
        return actor

    def vehicles(self) -> list[Actor]:
        return [actor for actor in self.actors.values() if actor.type_id.startswith("vehicle.")]

    def tick(self) -> int:
        self.frame += 1
        if self.fail_at_frame is not None and self.frame >= self.fail_at_frame:
            raise self.error
        for vehicle in self.vehicles():
            if vehicle.autopilot is not None:
                forward = vehicle.place.get_matrix()[:3, 0] * self.speed_mps * (self.settings.fixed_delta_seconds or 0)
                old = vehicle.place.location
                vehicle.place.location = Location(old.x + forward[0], old.y + forward[1], old.z + forward[2])
        self.places = {number: replace(actor.place) for number, actor in self.actors.items()}
        sensors = [actor for actor in self.actors.values() if actor.listener is not None]
        self._shuffle.shuffle(sensors)
        for sensor in sensors:
            if self.silent_sensor and self.silent_sensor in sensor.type_id:
                continue
            self._deliver(sensor)
        return self.frame

    def _deliver(self, sensor: Actor) -> None:
        """In a thread: the last reading once more, then the new one."""
        listener, before, now = sensor.listener, sensor.last_reading, self._reading(sensor)
        sensor.last_reading = now
        assert listener is not None

        def call_back() -> None:
            if before is not None:
                listener(before)
            listener(now)

        thread = threading.Thread(target=call_back)
        self._threads.append(thread)
        thread.start()

    def close(self) -> None:
        for thread in self._threads:
            thread.join()

    def _reading(self, sensor: Actor) -> Any:
        world_sensor = sensor.parent.place.get_matrix() @ sensor.place.get_matrix()
        boxes = []
        for vehicle in self.vehicles():
            box = vehicle.bounding_box
            inside = Transform(box.location, box.rotation).get_matrix()
            half = np.array([box.extent.x, box.extent.y, box.extent.z])
            boxes.append((vehicle.id, vehicle.place.get_matrix() @ inside, half))
        attributes = sensor.attributes
        if sensor.type_id == "sensor.lidar.ray_cast":
            channels = int(attributes["channels"])
            columns = round(
                float(attributes["points_per_second"]) * (self.settings.fixed_delta_seconds or 1) / channels
            )
            rays = lidar_rays(channels, columns, float(attributes["upper_fov"]), float(attributes["lower_fov"]))
            reach, _ = cast(world_sensor, rays, boxes)
            met = reach < float(attributes["range"])
            rows = np.concatenate([rays * reach[:, None], np.full((len(rays), 1), 0.5)], axis=1)[met]
            counts = met.reshape(channels, columns).sum(axis=1).tolist()
            return SimpleNamespace(
                frame=self.frame,
                raw_data=memoryview(rows.astype(np.float32).tobytes()),
                channels=channels,
                get_point_count=lambda channel: counts[channel],
            )
        width, height = int(attributes["image_size_x"]), int(attributes["image_size_y"])
        reach, what = cast(world_sensor, camera_rays(width, height, float(attributes["fov"])), boxes)
        car_tag = CAR_TAG_UNTIL_0_9_13 if self.version < "0.9.14" else CAR_TAG
        return Image(width, height, memoryview(_pixels(sensor.type_id, reach, what, car_tag).tobytes()), self.frame)


def _pixels(kind: str, reach: np.ndarray, what: np.ndarray, car_tag: int) -> np.ndarray:
    """(N, 4) uint8: blue, green, red, alpha."""
    vehicle = what > 0
    tag = np.where(vehicle, car_tag, GROUND_TAG)
    if kind.endswith("depth"):
        steps = np.rint(np.minimum(reach, 1000.0) / 1000.0 * (256**3 - 1)).astype(np.int64)
        red, green, blue = steps % 256, steps // 256 % 256, steps // 65536
    elif kind.endswith("semantic_segmentation"):
        red, green, blue = tag, 0 * tag, 0 * tag
    elif kind.endswith("instance_segmentation"):
        number = np.where(vehicle, what, ENGINE_NUMBER)
        red, green, blue = tag, number % 256, number // 256 % 256
    else:
        red, green, blue = np.where(vehicle, 200, 90), np.where(vehicle, 30, 90), np.where(vehicle, 30, 90)
    return np.stack([blue, green, red, np.full(len(reach), 255)], axis=1).astype(np.uint8)


class World:
    def __init__(self, server: Server) -> None:
        self._server = server

    def get_map(self) -> Any:
        return SimpleNamespace(
            name=f"Carla/Maps/{self._server.town}", get_spawn_points=lambda: list(self._server.spawn_points)
        )

    def get_settings(self) -> Any:
        return SimpleNamespace(**vars(self._server.settings))

    def apply_settings(self, settings: Any) -> int:
        self._server.call("apply_settings")
        self._server.settings = Settings(**vars(settings))
        return self._server.frame

    def get_weather(self) -> str:
        return self._server.weather

    def set_weather(self, weather: str) -> None:
        self._server.call("set_weather")
        self._server.weather = weather

    def get_blueprint_library(self) -> Blueprints:
        return Blueprints()

    def get_environment_objects(self, label: int) -> list[Any]:
        return [SimpleNamespace(id=number) for number in {14: (7001, 7002), 15: (7003,)}.get(label, ())]

    def enable_environment_objects(self, ids: set[int], enable: bool) -> None:
        self._server.hidden_scenery = self._server.hidden_scenery - ids if enable else self._server.hidden_scenery | ids

    def load_map_layer(self, layer: str) -> None:
        self._server.hidden_scenery.discard(-1)

    def unload_map_layer(self, layer: str) -> None:
        self._server.hidden_scenery.add(-1)

    def spawn_actor(self, blueprint: Blueprint, place: Transform, attach_to: Any = None) -> Actor:
        return self._server.spawn(blueprint, place, attach_to)

    def try_spawn_actor(self, blueprint: Blueprint, place: Transform) -> Actor | None:
        taken = any(
            abs(place.location.x - other.place.location.x) < 1 and abs(place.location.y - other.place.location.y) < 1
            for other in self._server.vehicles()
        )
        return None if taken else self._server.spawn(blueprint, replace(place))

    def get_actors(self) -> Actors:
        return Actors(self._server.actors.values())

    def get_snapshot(self) -> Any:
        places = self._server.places

        def find(number: int) -> Any:
            return SimpleNamespace(get_transform=lambda: places[number]) if number in places else None

        return SimpleNamespace(frame=self._server.frame, find=find)

    def tick(self, seconds: float) -> int:
        return self._server.tick()


class TrafficManager:
    def __init__(self, server: Server, port: int) -> None:
        self._server, self._port = server, port

    def get_port(self) -> int:
        return self._port

    def set_synchronous_mode(self, on: bool) -> None:
        self._server.traffic_synchronous = on

    def set_random_device_seed(self, seed: int) -> None:
        assert isinstance(seed, int)


class Client:
    def __init__(self, server: Server) -> None:
        self._server = server

    def set_timeout(self, seconds: float) -> None:
        assert seconds > 0

    def get_server_version(self) -> str:
        self._server.call("get_server_version")
        return self._server.version

    def get_client_version(self) -> str:
        return self._server.client_version

    def get_world(self) -> World:
        return World(self._server)

    def get_available_maps(self) -> list[str]:
        return [f"/Game/Carla/Maps/{town}" for town in self._server.towns]

    def load_world(self, town: str) -> World:
        self._server.town = town
        return World(self._server)

    def get_trafficmanager(self, port: int) -> TrafficManager:
        return TrafficManager(self._server, port)


def module_of(server: Server) -> Any:
    """What ``import carla`` would give, if it reached this server."""
    return SimpleNamespace(
        Client=lambda host, port: Client(server),
        Location=Location,
        Rotation=Rotation,
        Transform=Transform,
        WeatherParameters=SimpleNamespace(ClearNoon="clear noon"),
        MapLayer=SimpleNamespace(ParkedVehicles="parked vehicles"),
        CityObjectLabel=SimpleNamespace(Car=14, Truck=15, Roads=1),
    )
