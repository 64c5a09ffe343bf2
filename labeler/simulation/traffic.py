"""Who drives where: vehicles that wander through a simulated town, driven by SUMO, and vehicles parked there.

Each vehicle walks at random over the network, so no route has to be planned and no one leaves the town. SUMO keeps
lanes, gaps and signals; it writes where every front bumper is, and bodies trail it (see ``tractrix``). The file is read
as a stream, so a long drive needs no more memory than a short one.

Everything follows from the seed. The ego car is the one of the driving cars that goes farthest while it is recorded;
those that turn at a crossing come first.
"""

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from labeler.simulation.errors import SimulationError
from labeler.simulation.layout import Approach, JunctionId, ParkingSlot, TownLayout
from labeler.simulation.road_network import SPEED_LIMIT_MPS, Lamp, RoadNetwork, build_road_network
from labeler.simulation.sumo import run_sumo
from labeler.simulation.tractrix import center_of, jumped, trail, wrapped
from labeler.simulation.vehicles import VehicleModel

_WARM_UP_S = 20.0
_LONGEST_STEP_MS = 100
_TURN_RAD = np.radians(70.0)
_MODEL_WEIGHT = {"bus": 0.3, "truck": 0.5, "motorcycle": 0.5}
_LONG_M = 6.0
_ROUTES_SEED, _PARKING_SEED = 11, 12


@dataclass(frozen=True)
class TrafficConfig:
    """How much traffic there is. ``vehicles`` drive, the ego car among them. ``parked_share`` of the parking slots are
    taken. There are ``frames`` moments, ``period_ms`` apart, after a warm-up."""

    seed: int
    frames: int
    vehicles: int = 60
    period_ms: int = 100
    parked_share: float = 0.6

    def __post_init__(self) -> None:
        for name, least in (("seed", 0), ("frames", 1), ("vehicles", 1), ("period_ms", 10)):
            if getattr(self, name) < least:
                raise SimulationError(f"{name} must be at least {least}, not {getattr(self, name)}.")
        if not 0 <= self.parked_share <= 1:
            raise SimulationError(f"parked_share must lie between 0 and 1, not {self.parked_share}.")


@dataclass(frozen=True, eq=False)
class Placement:
    """Where V vehicles stand at one moment: ``vehicle_id`` (V,) int32; the middles of their bodies ``x_m``, ``y_m`` in
    the world and ``yaw_rad``, ``speed_mps`` (V,) float64; ``velocity_mps`` (V, 2) and ``yaw_rate_radps`` (V,) around
    that moment."""

    vehicle_id: NDArray[np.int32]
    x_m: NDArray[np.float64]
    y_m: NDArray[np.float64]
    yaw_rad: NDArray[np.float64]
    speed_mps: NDArray[np.float64]
    velocity_mps: NDArray[np.float64]
    yaw_rate_radps: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TrafficFrame:
    """One moment: where the driving vehicles are, and what each signal shows."""

    index: int
    driving: Placement
    lamps: Mapping[tuple[JunctionId, Approach], Lamp]


@dataclass(frozen=True, eq=False)
class Traffic:
    """All traffic of a drive. ``models`` names the model of every vehicle by its id, from 1 without gaps: first those
    that drive, then those that are ``parked``. ``ego_id`` is a driving car."""

    config: TrafficConfig
    models: Mapping[int, str]
    parked: Placement
    ego_id: int
    _network: RoadNetwork
    _lengths_m: NDArray[np.float64]
    _rear_axles_m: NDArray[np.float64]
    _file: Path

    def frames(self) -> Iterator[TrafficFrame]:
        """Every moment in turn, read from SUMO's file. SimulationError when a vehicle or a moment is missing."""
        every = _steps_per_frame(self.config)
        step_s = self.config.period_ms / 1000 / every
        for step, placement in _placements(_bodies(self._file, self._lengths_m, self._rear_axles_m), step_s):
            since_start = step - _first_step(self.config)
            if since_start < 0 or since_start % every:
                continue
            index = since_start // every
            missing = self.config.vehicles - len(placement.vehicle_id)
            if missing:
                raise SimulationError(
                    f"{missing} of {self.config.vehicles} vehicles found no room in the town. "
                    "Take fewer vehicles or a larger town."
                )
            lamps: dict[tuple[JunctionId, Approach], Lamp] = {
                (program.junction_id, approach): program.lamp_at(approach, step * step_s)
                for program in self._network.programs
                for approach in program.lamps
            }
            yield TrafficFrame(index, placement, lamps)
            if index + 1 == self.config.frames:
                return
        raise SimulationError("SUMO ended before the drive did: vehicles left the town or it has no room for them.")


def simulate_traffic(layout: TownLayout, fleet: Sequence[VehicleModel], config: TrafficConfig, folder: Path) -> Traffic:
    """Let traffic run in a town; SUMO's files are kept in ``folder``, from which frames are read later.

    SimulationError when SUMO is missing or fails, or when the town has no room for all vehicles."""
    network = build_road_network(layout, folder)
    rng = np.random.default_rng([config.seed, _ROUTES_SEED])
    driving = _choose_models(rng, fleet, config.vehicles)
    routes = folder / "town.rou.xml"
    _write_routes(routes, rng, network, layout, fleet, driving, config)
    file = folder / "town.fcd.xml"
    every = _steps_per_frame(config)
    end_s = (_first_step(config) + config.frames * every + 1) * config.period_ms / 1000 / every
    run_sumo(
        "sumo",
        {
            "net-file": str(network.file),
            "additional-files": str(network.signals_file),
            "route-files": str(routes),
            "fcd-output": str(file),
            "fcd-output.attributes": "x,y,angle,speed",
            "precision": "4",
            "step-length": f"{config.period_ms / 1000 / every:.3f}",
            "end": f"{end_s:.3f}",
            "seed": str(config.seed),
            "lanechange.duration": "2.5",
            "time-to-teleport": "-1",
            "collision.action": "none",
            "no-step-log": "true",
        },
    )
    parked_models, parked = _park(layout, fleet, config)
    models = [model.name for model in (*driving, *parked_models)]
    traffic = Traffic(
        config=config,
        models={index + 1: name for index, name in enumerate(models)},
        parked=parked,
        ego_id=1,
        _network=network,
        _lengths_m=np.array([model.size_m[0] for model in driving]),
        _rear_axles_m=np.array([model.size_m[0] / 2 - model.rear_axle_m for model in driving]),
        _file=file,
    )
    cars = [index + 1 for index, model in enumerate(driving) if model.category == "car"]
    return replace(traffic, ego_id=_choose_ego(traffic, cars))


def _choose_models(rng: np.random.Generator, fleet: Sequence[VehicleModel], count: int) -> list[VehicleModel]:
    """The first is a car, as the ego car has to be one."""
    driven = [model for model in fleet if model.drives]
    weights = np.array([_MODEL_WEIGHT.get(model.category, 1.0) for model in driven])
    chosen = [driven[int(k)] for k in rng.choice(len(driven), size=count, p=weights / weights.sum())]
    cars = [model for model in driven if model.category == "car"]
    if not cars:
        raise SimulationError("The fleet holds no car that could be the ego car.")
    chosen[0] = cars[int(rng.integers(len(cars)))]
    return chosen


def _write_routes(
    file: Path,
    rng: np.random.Generator,
    network: RoadNetwork,
    layout: TownLayout,
    fleet: Sequence[VehicleModel],
    driving: Sequence[VehicleModel],
    config: TrafficConfig,
) -> None:
    """A type for each model, and for each vehicle a random walk that is long enough for the whole drive."""
    root = ET.Element("routes")
    for model in fleet:
        length_m, width_m, _ = model.size_m
        long = length_m > _LONG_M
        kind = {
            "id": model.name,
            "length": f"{length_m:.3f}",
            "width": f"{width_m:.3f}",
            "minGap": "2.0",
            "accel": "1.3" if long else "2.4",
            "decel": "4.0",
            "maxSpeed": "11" if long else "15",
            "sigma": "0.5",
            "speedDev": "0.12",
            "lcSpeedGain": "0.6",
        }
        ET.SubElement(root, "vType", kind)
    duration_s = _WARM_UP_S + config.frames * config.period_ms / 1000
    shortest_m = min(edge.length_m for edge in layout.edges)
    edges_each = int(duration_s * SPEED_LIMIT_MPS * 1.3 / shortest_m) + 5
    starts = sorted(network.following)
    for index, model in enumerate(driving):
        long = model.size_m[0] > _LONG_M
        walk = [starts[int(rng.integers(len(starts)))]]
        while len(walk) < edges_each:
            ways_on = (network.without_right_turns if long else network.following)[walk[-1]]
            walk.append(ways_on[int(rng.integers(len(ways_on)))])
        departs = {"depart": "0", "departSpeed": "0", "departLane": "best", "departPos": "random_free"}
        vehicle = ET.SubElement(root, "vehicle", {"id": str(index + 1), "type": model.name} | departs)
        ET.SubElement(vehicle, "route", {"edges": " ".join(walk)})
    ET.ElementTree(root).write(file, encoding="utf-8", xml_declaration=True)


def _park(
    layout: TownLayout, fleet: Sequence[VehicleModel], config: TrafficConfig
) -> tuple[list[VehicleModel], Placement]:
    """Vehicles on a share of the parking slots, a little askew, as people park."""
    rng = np.random.default_rng([config.seed, _PARKING_SEED])
    taken = [slot for slot in layout.slots if rng.random() < config.parked_share]
    models: list[VehicleModel] = []
    places: list[tuple[float, float, float]] = []
    for slot in taken:
        fitting = [model for model in fleet if model.parks and _fits(model, slot)]
        if not fitting:
            continue
        weights = np.array([_MODEL_WEIGHT.get(model.category, 1.0) for model in fitting])
        model = fitting[int(rng.choice(len(fitting), p=weights / weights.sum()))]
        free_m = slot.length_m - model.size_m[0] - 0.4
        along_m, aside_m = rng.uniform(-0.5, 0.5) * free_m, float(np.clip(rng.normal(0, 0.05), -0.1, 0.1))
        cos, sin = np.cos(slot.yaw_rad), np.sin(slot.yaw_rad)
        yaw_rad = slot.yaw_rad + float(np.clip(rng.normal(0, 0.012), -0.03, 0.03))
        places.append((slot.x_m + cos * along_m - sin * aside_m, slot.y_m + sin * along_m + cos * aside_m, yaw_rad))
        models.append(model)
    at = np.array(places, dtype=np.float64).reshape(-1, 3)
    count = len(models)
    return models, Placement(
        vehicle_id=np.arange(config.vehicles + 1, config.vehicles + 1 + count, dtype=np.int32),
        x_m=at[:, 0],
        y_m=at[:, 1],
        yaw_rad=wrapped(at[:, 2]),
        speed_mps=np.zeros(count),
        velocity_mps=np.zeros((count, 2)),
        yaw_rate_radps=np.zeros(count),
    )


def _fits(model: VehicleModel, slot: ParkingSlot) -> bool:
    return model.size_m[0] < slot.length_m - 0.5 and model.size_m[1] < slot.width_m + 0.05


def _choose_ego(traffic: Traffic, cars: Sequence[int]) -> int:
    """The car among ``cars`` that drives farthest, of those that turn at a crossing where there are any."""
    ids = np.array(cars)
    way_m, turned_rad, most_turned_rad = (np.zeros(len(cars)) for _ in range(3))
    for frame in traffic.frames():
        rows = np.searchsorted(frame.driving.vehicle_id, ids)
        way_m += frame.driving.speed_mps[rows] * traffic.config.period_ms / 1000
        turned_rad += frame.driving.yaw_rate_radps[rows] * traffic.config.period_ms / 1000
        most_turned_rad = np.maximum(most_turned_rad, np.abs(turned_rad))
    turns = (most_turned_rad > _TURN_RAD).astype(np.float64)
    return int(ids[np.lexsort((-way_m, -turns))[0]])


def _steps_per_frame(config: TrafficConfig) -> int:
    """SUMO takes steps of at most 0.1 s, in whole milliseconds, of which a whole number makes a frame."""
    steps = -(-config.period_ms // _LONGEST_STEP_MS)
    while config.period_ms % steps:
        steps += 1
    return steps


def _first_step(config: TrafficConfig) -> int:
    return round(_WARM_UP_S * 1000 / config.period_ms) * _steps_per_frame(config)


def _placements(steps: "Iterator[_Bodies]", step_s: float) -> Iterator[tuple[int, Placement]]:
    """Every step but the first and the last, with the velocity between its neighbours."""
    before = now = None
    for step, after in enumerate(steps):
        if before is not None and now is not None and len(before[0]) == len(now[0]) == len(after[0]):
            ids, center_m, yaw_rad, speed_mps = now
            yield (
                step - 1,
                Placement(
                    vehicle_id=ids,
                    x_m=center_m[:, 0],
                    y_m=center_m[:, 1],
                    yaw_rad=yaw_rad,
                    speed_mps=speed_mps,
                    velocity_mps=(after[1] - before[1]) / (2 * step_s),
                    yaw_rate_radps=wrapped(after[2] - before[2]) / (2 * step_s),
                ),
            )
        before, now = now, after


_Bodies = tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]


def _bodies(file: Path, lengths_m: NDArray[np.float64], rear_axles_m: NDArray[np.float64]) -> Iterator[_Bodies]:
    """Ids, centres (V, 2), yaws and speeds of each step, the bodies trailing SUMO's front bumpers.

    ``rear_axles_m`` are the distances from front bumpers to rear axles."""
    count = len(lengths_m)
    front_m, yaw_rad = np.full((count, 2), np.nan), np.zeros(count)
    for rows in _read_fcd(file):
        index = np.array(sorted(rows), dtype=np.int32) - 1
        values = np.array([rows[int(k) + 1] for k in index], dtype=np.float64).reshape(-1, 4)
        after_m, lane_yaw_rad = values[:, :2], wrapped(np.pi / 2 - np.radians(values[:, 2]))
        before_m = front_m[index]
        trailing_rad = trail(before_m, after_m, yaw_rad[index], rear_axles_m[index])
        fresh = np.isnan(before_m).any(axis=1) | jumped(before_m, after_m)
        front_m[index], yaw_rad[index] = after_m, np.where(fresh, lane_yaw_rad, trailing_rad)
        yield index + 1, center_of(after_m, yaw_rad[index], lengths_m[index]), yaw_rad[index].copy(), values[:, 3]


def _read_fcd(file: Path) -> Iterator[dict[int, tuple[float, float, float, float]]]:
    """For each step the front's x, y, angle in degrees from north and speed of every vehicle, by id."""
    events = ET.iterparse(file, events=("start", "end"))
    _, root = next(events)
    for event, element in events:
        if event == "end" and element.tag == "timestep":
            yield {
                int(row.get("id", "0")): (
                    float(row.get("x", "nan")),
                    float(row.get("y", "nan")),
                    float(row.get("angle", "nan")),
                    float(row.get("speed", "nan")),
                )
                for row in element
            }
            root.clear()
