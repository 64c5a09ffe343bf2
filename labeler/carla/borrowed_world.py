"""A CARLA world that is set up for a recording, and given back as it was found.

The world goes step by step at a fixed interval (synchronous mode), the weather is clear, scenery that looks like
vehicles is hidden since it has no truth, and vehicles drive by the traffic manager, which turns at random at
intersections. All of it is undone at the end, whatever ended the recording. CARLA tells nothing of how its traffic
manager was set, so that is put back to its default, asynchronous.
"""

import math
import random
from collections.abc import Callable
from types import TracebackType
from typing import Any, Self

from labeler.carla.config import CarlaConfig
from labeler.carla.errors import CarlaError

_PHYSICS_STEP_S = 0.01
_MOST_PHYSICS_STEPS = 16
_SCENERY_VEHICLES = ("Vehicles", "Car", "Truck", "Bus", "Motorcycle", "Bicycle")
"""Names of ``carla.CityObjectLabel``; the first is of 0.9.12 and 0.9.13, the others of later versions."""
_WHEELS = 4


class BorrowedWorld:
    """A world with traffic around ``ego``, a ``carla.Vehicle``. Use it in a ``with`` statement.

    CarlaError when the server does not have the town, its map has no room for the vehicles, or a call fails;
    ``not_restored`` says then and afterwards what could not be undone."""

    def __init__(self, carla: Any, client: Any, config: CarlaConfig) -> None:
        self._carla, self._client, self._config = carla, client, config
        self.world: Any = None
        self.ego: Any = None
        self.not_restored: list[str] = []
        self._vehicles: list[Any] = []
        self._sensors: list[Any] = []
        self._undo: list[tuple[str, Callable[[], object]]] = []

    def __enter__(self) -> Self:
        try:
            self._set_up()
        except BaseException:  # a stop by Ctrl-C too: the world is somebody else's
            self.restore()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.restore()

    def attach(self, blueprint: Any, place: Any, listener: Callable[[Any], None]) -> None:
        """Fix a sensor to the ego car at a ``carla.Transform`` in its frame; other threads call ``listener``."""
        sensor = self.world.spawn_actor(blueprint, place, attach_to=self.ego)
        self._sensors.append(sensor)
        sensor.listen(listener)

    def tick(self) -> int:
        """Go on by one interval; the number of the frame that it makes."""
        return int(self.world.tick(self._config.timeout_s))

    def restore(self) -> None:
        """Undo everything, the next thing also where one fails."""
        for sensor in self._sensors:
            self._attempt("a sensor still runs", sensor.stop)
        while self._undo:
            self._attempt(*self._undo.pop())
        for actor in (*reversed(self._sensors), *reversed(self._vehicles)):
            self._attempt(f"{actor.type_id} {actor.id} is still there", actor.destroy)
        self._sensors, self._vehicles = [], []

    def _attempt(self, otherwise: str, step: Callable[[], object]) -> None:
        try:
            step()
        except RuntimeError as error:
            self.not_restored.append(f"{otherwise} ({error})")

    def _set_up(self) -> None:
        config = self._config
        self.world = self._world_of_town()
        self._step_by_interval()
        self._clear_weather()
        self._hide_scenery_vehicles()
        traffic = self._client.get_trafficmanager(config.traffic_port)
        self._undo.append(("the traffic manager is synchronous", lambda: traffic.set_synchronous_mode(False)))
        traffic.set_synchronous_mode(True)
        traffic.set_random_device_seed(config.seed)
        self._spawn_traffic(traffic.get_port())
        for _ in range(round(config.warm_up_s / config.interval_s)):
            self.tick()

    def _world_of_town(self) -> Any:
        """The world as it is where it shows the town already, else the town's."""
        town, world = self._config.town, self._client.get_world()
        if _last_part(world.get_map().name) == town:
            return world
        towns = sorted(_last_part(name) for name in self._client.get_available_maps())
        if town not in towns:
            raise CarlaError(f"The CARLA server has no town {town}. It has {', '.join(towns)}: choose one with --town.")
        return self._client.load_world(town)

    def _step_by_interval(self) -> None:
        before, settings = self.world.get_settings(), self.world.get_settings()
        steps = min(_MOST_PHYSICS_STEPS, math.ceil(round(self._config.interval_s / _PHYSICS_STEP_S, 6)))
        settings.synchronous_mode = True
        settings.fixed_delta_seconds = self._config.interval_s
        settings.no_rendering_mode = False
        settings.substepping = True
        settings.max_substeps = steps
        settings.max_substep_delta_time = self._config.interval_s / steps
        self._undo.append(
            ("the world's settings are those of the recording", lambda: self.world.apply_settings(before))
        )
        self.world.apply_settings(settings)

    def _clear_weather(self) -> None:
        before = self.world.get_weather()
        self._undo.append(("the weather is clear", lambda: self.world.set_weather(before)))
        self.world.set_weather(self._carla.WeatherParameters.ClearNoon)

    def _hide_scenery_vehicles(self) -> None:
        """Maps named _Opt have a layer of them; what other maps show is hidden one by one."""
        world, carla = self.world, self._carla
        if self._config.town.endswith("_Opt"):
            layer = carla.MapLayer.ParkedVehicles
            self._undo.append(("parked vehicles are hidden", lambda: world.load_map_layer(layer)))
            world.unload_map_layer(layer)
        labels = [getattr(carla.CityObjectLabel, name, None) for name in _SCENERY_VEHICLES]
        ids = {scenery.id for label in labels if label is not None for scenery in world.get_environment_objects(label)}
        if ids:
            self._undo.append(
                ("vehicles of the scenery are hidden", lambda: world.enable_environment_objects(ids, True))
            )
            world.enable_environment_objects(ids, False)

    def _spawn_traffic(self, traffic_port: int) -> None:
        """The ego car and as many others as asked for, at places and of models that follow from the seed."""
        config, rng = self._config, random.Random(self._config.seed)
        library = self.world.get_blueprint_library()
        models = sorted(
            (model for model in library.filter("vehicle.*") if int(model.get_attribute("number_of_wheels")) >= _WHEELS),
            key=lambda model: str(model.id),
        )
        places = list(self.world.get_map().get_spawn_points())
        rng.shuffle(places)
        for place in places:
            if len(self._vehicles) == config.vehicles:
                break
            model = library.find(config.ego_model) if self.ego is None else rng.choice(models)
            model.set_attribute("role_name", "hero" if self.ego is None else "autopilot")
            if model.has_attribute("color"):
                model.set_attribute("color", rng.choice(model.get_attribute("color").recommended_values))
            vehicle = self.world.try_spawn_actor(model, place)
            if vehicle is not None:
                self._vehicles.append(vehicle)
                self.ego = self.ego or vehicle
                vehicle.set_autopilot(True, traffic_port)
        if len(self._vehicles) < config.vehicles:
            raise CarlaError(
                f"{config.town} has room for {len(self._vehicles)} vehicles now, not for {config.vehicles}: "
                "ask for fewer with --vehicles, or remove those that other programs have left."
            )


def _last_part(map_name: str) -> str:
    return map_name.rsplit("/", 1)[-1]
