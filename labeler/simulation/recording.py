"""Simulates a drive and writes it down: a town, traffic in it, and what the ego car's sensors record, with the truth.

The main loop goes over moments: place every vehicle, draw the four cameras, scan with the LiDAR, write all of it with
the truth. Nothing is kept from one moment to the next, so memory does not grow with the drive. Each moment's noise has
its own seed, so a drive that was stopped goes on to the same bytes.
"""

import tempfile
from collections.abc import Mapping
from contextlib import closing
from dataclasses import asdict, dataclass
from importlib import metadata
from pathlib import Path
from typing import Protocol
from uuid import UUID, uuid5

import numpy as np
from numpy.typing import NDArray

from labeler.geometry.se3 import invert_se3, se3
from labeler.simulation.errors import SimulationError
from labeler.simulation.graphics import open_context
from labeler.simulation.lidar import LidarConfig, Motion, MovingSolid, Scan, scan
from labeler.simulation.lighting import Lighting, lighting_of
from labeler.simulation.log import SimulatedLog, require_free
from labeler.simulation.materials import REFLECTIVITY, Material
from labeler.simulation.meshes import Mesh
from labeler.simulation.renderer import CameraView, Renderer, Rendering, VehicleInstance
from labeler.simulation.rig import Rig
from labeler.simulation.solids import Solid, load_embree
from labeler.simulation.sumo import sumo_home
from labeler.simulation.towns import town_style
from labeler.simulation.traffic import Placement, Traffic, TrafficConfig, TrafficFrame, simulate_traffic
from labeler.simulation.truth import Target, TrueBox, boxes_in_image
from labeler.simulation.vehicles import Paint
from labeler.simulation.world import SimulatedWorld

VERSION = 1
"""Of what a seed leads to: goes up when the same settings give another drive."""
START_NS = 1_700_000_000_000_000_000
_SEEN_UNTIL_M = 300.0
_TRUTH_UNTIL_M = 100.0
_IMAGE_NOISE = 1.2
_IMAGE_SEED, _LIDAR_SEED, _PAINT_SEED = 21, 22, 23
_UUID_SPACE = UUID("6f0a9c1e-6a1c-4c39-9d5b-3d7a1f0c52e4")
_PACKAGES = ("hindsight-labeler", "eclipse-sumo", "embreex", "moderngl")


class Progress(Protocol):
    """Hears how far the simulation is."""

    def stage(self, name: str, units: int) -> None:
        """A stage begins that has this many units of work left to do."""
        ...

    def advance(self, units: int = 1) -> None:
        """Units of the current stage are done."""
        ...


@dataclass(frozen=True)
class SimulationConfig:
    """A drive: how long, how much traffic, how it is recorded. Everything follows from these.

    ``vehicles`` drive, the ego car among them; ``parked_share`` of the parking slots are taken. ``rate_hz`` moments a
    second, each with four images of ``width_px`` by ``height_px`` and a LiDAR sweep of ``lidar_channels`` beams and
    ``lidar_columns`` readings a turn. ``town`` and ``light`` name kinds of town and of light; without a light, the seed
    chooses one. With ``semantic`` the class of each pixel is written beside each image; with ``truth_only`` neither
    images nor sweeps are written, only calibration, poses and 3D boxes."""

    seed: int
    frames: int
    vehicles: int = 60
    rate_hz: float = 10.0
    width_px: int = 720
    height_px: int = 360
    town: str = "grid"
    light: str | None = None
    parked_share: float = 0.6
    jpeg_quality: int = 90
    lidar_channels: int = 64
    lidar_columns: int = 1800
    semantic: bool = False
    truth_only: bool = False

    def __post_init__(self) -> None:
        if not 0.5 <= self.rate_hz <= 50:
            raise SimulationError(f"The rate must lie between 0.5 and 50 a second, not {self.rate_hz}.")
        if not (64 <= self.width_px <= 4096 and 64 <= self.height_px <= 4096):
            raise SimulationError(
                f"Images must have sides of 64 to 4096 pixels, not {self.width_px} x {self.height_px}."
            )
        if not 1 <= self.jpeg_quality <= 100:
            raise SimulationError(f"The JPEG quality must lie between 1 and 100, not {self.jpeg_quality}.")
        self.traffic()
        self.lidar()
        town_style(self.town)
        lighting_of(self.seed, name=self.light)

    @property
    def period_ms(self) -> int:
        """Between two moments; SUMO counts whole milliseconds."""
        return round(1000 / self.rate_hz)

    def timestamp_ns(self, index: int) -> int:
        return START_NS + index * self.period_ms * 1_000_000

    def traffic(self) -> TrafficConfig:
        return TrafficConfig(self.seed, self.frames, self.vehicles, self.period_ms, self.parked_share)

    def lidar(self) -> LidarConfig:
        return LidarConfig(self.lidar_channels, self.lidar_columns, turn_s=min(0.1, self.period_ms / 1000))


def simulate_drive(folder: Path, config: SimulationConfig, progress: Progress) -> None:
    """Record the drive that follows from ``config`` in ``folder``, which must not be there yet.

    SimulationError when a part of the extra ``simulation`` is missing, when there is no OpenGL, when the town has no
    room for the vehicles, or when ``folder`` can't be written. A drive that was stopped goes on when the same is asked
    for again."""
    require_free(folder)
    _require_extra(with_images=not config.truth_only)
    progress.stage("Building the town", 1)
    world = SimulatedWorld.build(config.seed, town=config.town)
    progress.advance()
    with tempfile.TemporaryDirectory(prefix="hindsight-simulation-") as scratch:
        progress.stage("Letting traffic run", 1)
        models = tuple(world.models.values())
        traffic = simulate_traffic(world.layout, models, config.traffic(), Path(scratch))
        progress.advance()
        log = SimulatedLog(folder, _about(config), jpeg_quality=config.jpeg_quality)
        progress.stage("Recording moments", sum(not log.has(config.timestamp_ns(k)) for k in range(config.frames)))
        with closing(_Recorder(config, world, traffic)) as recorder:
            log.write_calibration(recorder.rig)
            for frame in traffic.frames():
                if not log.has(config.timestamp_ns(frame.index)):
                    recorder.record(frame, log)
                    progress.advance()
    log.publish([config.timestamp_ns(index) for index in range(config.frames)])


def _require_extra(*, with_images: bool) -> None:
    """SimulationError when a part of the extra ``simulation``, or OpenGL where images are to be drawn, is missing,
    before the long work begins."""
    sumo_home()
    load_embree()
    if with_images:
        open_context().release()


class _Recorder:
    """Records single moments of one drive."""

    def __init__(self, config: SimulationConfig, world: SimulatedWorld, traffic: Traffic) -> None:
        self._config, self._lidar, self._traffic, self._models = config, config.lidar(), traffic, world.models
        ego = world.models[traffic.models[traffic.ego_id]]
        self.rig = Rig.on_roof(
            rear_axle_m=ego.rear_axle_m,
            height_m=ego.size_m[2],
            width_px=config.width_px,
            height_px=config.height_px,
        )
        self._renderer = None if config.truth_only else Renderer(world, config.width_px, config.height_px)
        self._lighting: Lighting = lighting_of(config.seed, name=config.light)
        positions_m, faces, material = world.static_triangles()
        self._town = Solid(positions_m[faces], _reflectance(material))
        self._solids = {name: _solid_of(model.mesh) for name, model in world.models.items()}
        self._paints = _paints(config.seed, traffic, world)
        self._uuids = {number: str(uuid5(_UUID_SPACE, f"{config.seed}/{number}")) for number in traffic.models}

    def close(self) -> None:
        if self._renderer is not None:
            self._renderer.close()

    def record(self, frame: TrafficFrame, log: SimulatedLog) -> None:
        """Write one moment: images and sweep, where they are wanted, and the truth."""
        config, timestamp_ns = self._config, self._config.timestamp_ns(frame.index)
        motions = _motions(frame.driving) | _motions(self._traffic.parked)
        ego = motions.pop(self._traffic.ego_id)
        world_SE3_ego = _world_SE3_body(ego) @ self.rig.body_SE3_ego
        near = {number: motion for number, motion in motions.items() if _apart_m(motion, ego) <= _SEEN_UNTIL_M}
        targets = [self._target(number, motion, world_SE3_ego) for number, motion in near.items()]
        boxes: dict[str, list[TrueBox]] | None = None
        if self._renderer is not None:
            renderings = self._render(self._renderer, frame, ego, near, world_SE3_ego)
            rng = np.random.default_rng([config.seed, _IMAGE_SEED, frame.index])
            boxes = {}
            for view, rendering in zip(self.rig.views, renderings, strict=True):
                log.write_image(view.camera, timestamp_ns, _with_noise(rendering.image, rng))
                if config.semantic:
                    log.write_semantic(view.camera, timestamp_ns, rendering.semantic)
                boxes[view.camera] = boxes_in_image(view, rendering.ids, targets)
        swept = self._scan(frame.index, ego, near)
        if not config.truth_only:
            log.write_sweep(timestamp_ns, swept)
        log.finish_moment(
            timestamp_ns,
            city_SE3_ego=world_SE3_ego,
            targets=[target for target in targets if target.distance_m <= _TRUTH_UNTIL_M],
            boxes=boxes,
            scan=swept,
        )

    def _render(
        self,
        renderer: Renderer,
        frame: TrafficFrame,
        ego: Motion,
        near: Mapping[int, Motion],
        world_SE3_ego: NDArray[np.float64],
    ) -> list[Rendering]:
        views = [CameraView(world_SE3_ego @ view.ego_SE3_camera, view.intrinsics) for view in self.rig.views]
        instances = [self._instance(number, motion) for number, motion in near.items()]
        instances.append(self._instance(self._traffic.ego_id, ego, visible=False))
        return renderer.render(views, instances, self._lighting, frame.lamps)

    def _instance(self, number: int, motion: Motion, *, visible: bool = True) -> VehicleInstance:
        return VehicleInstance(
            number, self._traffic.models[number], _world_SE3_body(motion), self._paints[number], visible
        )

    def _scan(self, index: int, ego: Motion, near: Mapping[int, Motion]) -> Scan:
        """In the ego frame: the ego car moves as its body does, seen from the rear axle."""
        sensor_in_body_m = (self.rig.body_SE3_ego @ np.array([*self.rig.lidar_m, 1.0]))[:3]
        in_body = scan(
            self._lidar,
            ego=ego,
            sensor_m=(float(sensor_in_body_m[0]), float(sensor_in_body_m[1]), float(sensor_in_body_m[2])),
            town=self._town,
            vehicles=[
                MovingSolid(number, self._solids[self._traffic.models[number]], motion)
                for number, motion in near.items()
            ],
            rng=np.random.default_rng([self._config.seed, _LIDAR_SEED, index]),
        )
        return in_body.moved(invert_se3(self.rig.body_SE3_ego))

    def _target(self, number: int, motion: Motion, world_SE3_ego: NDArray[np.float64]) -> Target:
        model = self._models[self._traffic.models[number]]
        return Target(
            vehicle_id=number,
            track_uuid=self._uuids[number],
            category=model.category,
            solid=self._solids[model.name],
            size_m=model.size_m,
            ego_SE3_body=invert_se3(world_SE3_ego) @ _world_SE3_body(motion),
        )


def _about(config: SimulationConfig) -> dict[str, object]:
    """What a drive says of itself."""
    versions = {name: _version(name) for name in _PACKAGES}
    settings = {name: value for name, value in asdict(config).items() if name != "truth_only" or value}
    return {"simulation_version": VERSION, "settings": settings, "made_with": versions}


def _version(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def _paints(seed: int, traffic: Traffic, world: SimulatedWorld) -> dict[int, Paint]:
    rng = np.random.default_rng([seed, _PAINT_SEED])
    choices = {number: world.models[name].paints for number, name in sorted(traffic.models.items())}
    return {number: paints[int(rng.integers(len(paints)))] for number, paints in choices.items()}


def _motions(placement: Placement) -> dict[int, Motion]:
    return {
        int(placement.vehicle_id[row]): Motion(
            float(placement.x_m[row]),
            float(placement.y_m[row]),
            float(placement.yaw_rad[row]),
            (float(placement.velocity_mps[row, 0]), float(placement.velocity_mps[row, 1])),
            float(placement.yaw_rate_radps[row]),
        )
        for row in range(len(placement.vehicle_id))
    }


def _world_SE3_body(motion: Motion) -> NDArray[np.float64]:
    cos, sin = np.cos(motion.yaw_rad), np.sin(motion.yaw_rad)
    return se3(np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]), [motion.x_m, motion.y_m, 0.0])


def _apart_m(a: Motion, b: Motion) -> float:
    return float(np.hypot(a.x_m - b.x_m, a.y_m - b.y_m))


def _solid_of(mesh: Mesh) -> Solid:
    return Solid(mesh.position_m[mesh.faces], _reflectance(mesh.material))


def _reflectance(material: NDArray[np.uint8]) -> NDArray[np.float64]:
    table = np.array([REFLECTIVITY[Material(number)] for number in range(len(Material))])
    return table[material]


def _with_noise(image: NDArray[np.uint8], rng: np.random.Generator) -> NDArray[np.uint8]:
    """The image with a camera's noise on it."""
    noise = rng.standard_normal(image.shape, dtype=np.float32) * _IMAGE_NOISE
    return np.clip(np.rint(image + noise), 0, 255).astype(np.uint8)
