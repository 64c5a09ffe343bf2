"""Records a drive from a CARLA server in the native format: four roof cameras, a LiDAR, and the truth.

The main loop goes over moments: let the world go on by one interval, wait until every sensor has delivered that frame,
take the vehicles' places of the same frame, and write all of it. A moment is written whole or not at all, and what a
recording had when it was stopped becomes a drive.
"""

import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Protocol
from uuid import uuid4

import numpy as np
from numpy.typing import NDArray

from labeler.carla.borrowed_world import BorrowedWorld
from labeler.carla.config import CarlaConfig
from labeler.carla.connection import INSTALL_COMMAND, CarlaVersion, connect
from labeler.carla.coordinates import parent_SE3_child, pixels_of, points_of
from labeler.carla.errors import CarlaError
from labeler.carla.rig import COLOURS, DEPTH, INSTANCES, LIDAR, SEMANTICS, attach_sensors, rig_of, sensor_name
from labeler.carla.vehicles import VehicleTruth, actor_SE3_body
from labeler.carla.visibility import ids_from_depth, ids_from_instances, true_boxes
from labeler.geometry.se3 import invert_se3, transform_points
from labeler.simulation.errors import SimulationError
from labeler.simulation.lidar import Scan
from labeler.simulation.log import SimulatedLog, require_free
from labeler.simulation.rig import View
from labeler.simulation.solids import load_embree
from labeler.simulation.truth import Target, TrueBox

_SETTLING_TICKS = 2
_OWN_CAR_MARGIN_M = 0.1


class Progress(Protocol):
    """Hears how far the recording is."""

    def stage(self, name: str, units: int) -> None:
        """A stage begins that has this many units of work."""
        ...

    def advance(self, units: int = 1) -> None:
        """Units of the current stage are done."""
        ...


@dataclass(frozen=True)
class Recorded:
    """What became of a recording: how many moments, of what server, and what a person should know."""

    moments: int
    version: CarlaVersion
    warnings: tuple[str, ...]


def record_drive(carla: Any, folder: Path, config: CarlaConfig, progress: Progress) -> Recorded:
    """Record a drive in ``folder``, which must not be there yet, from a server; ``carla`` is its client's module.

    The server is left as it was found, whatever happens, but that it keeps showing the town. CarlaError when the
    server can't be reached or used, or fails, when embreex is missing, or when ``folder`` can't be written;
    SimulationError when ``folder`` is there. When the server fails or Ctrl-C is pressed, the moments that were recorded
    until then become a drive; a KeyboardInterrupt then carries what could not be undone."""
    require_free(folder)
    _require_embree()
    progress.stage("Connecting to CARLA", 1)
    client, version = connect(carla, config.host, config.port, timeout_s=config.timeout_s)
    progress.advance()
    borrowed = BorrowedWorld(carla, client, config)
    recorder = _Recorder(folder, config, version)
    try:
        progress.stage("Letting traffic start", 1)
        with borrowed:
            recorder.begin(carla, borrowed)
            progress.advance()
            progress.stage("Recording moments", config.frames)
            for _ in range(config.frames):
                recorder.record_moment()
                progress.advance()
    except KeyboardInterrupt as stop:
        recorder.publish()
        raise KeyboardInterrupt(*_not_restored(borrowed)) from stop
    except (RuntimeError, CarlaError) as error:
        recorder.publish()
        raise CarlaError(_failure(error, recorder, borrowed)) from error
    except SimulationError as error:  # its own message promises to go on from there, which no server can
        raise CarlaError(
            f"{folder} can't be written ({error.__cause__ or error}). Mend that, and record again."
        ) from error
    recorder.publish()
    return Recorded(recorder.moments, version, tuple(_not_restored(borrowed)))


class _Recorder:
    """Records the moments of one drive, one after the other."""

    def __init__(self, folder: Path, config: CarlaConfig, version: CarlaVersion) -> None:
        self.folder, self._config, self._version = folder, config, version
        self._recording = uuid4()
        self._start_ns = time.time_ns()
        self._timestamps_ns: list[int] = []
        self._log: SimulatedLog | None = None

    @property
    def moments(self) -> int:
        return len(self._timestamps_ns)

    def begin(self, carla: Any, borrowed: BorrowedWorld) -> None:
        """Fix the sensors to the ego car, and let them deliver their first frames, which may be incomplete."""
        self._borrowed = borrowed
        self._rig = rig_of(borrowed.ego, self._config)
        self._truth = VehicleTruth(int(borrowed.ego.id), self._recording)
        self._assembly = attach_sensors(carla, borrowed, self._rig, self._version, self._config)
        for _ in range(_SETTLING_TICKS):
            borrowed.tick()

    def record_moment(self) -> None:
        """Go on by one interval, and write what the sensors saw and what is true."""
        frame = self._borrowed.tick()
        readings = self._assembly.take(frame, timeout_s=self._config.timeout_s)
        snapshot = self._borrowed.world.get_snapshot()
        if int(snapshot.frame) != frame:
            raise CarlaError(
                f"The CARLA world went on to frame {snapshot.frame} while frame {frame} was recorded. "
                "Another program moves it: stop that one."
            )
        targets = self._truth.targets(self._borrowed.world, snapshot)
        city_SE3_ego = parent_SE3_child(snapshot.find(self._borrowed.ego.id).get_transform())
        timestamp_ns = self._start_ns + round(self.moments * self._config.interval_s * 1e9)
        try:
            self._write(timestamp_ns, readings, targets, city_SE3_ego)
        except KeyboardInterrupt:
            self._write(timestamp_ns, readings, targets, city_SE3_ego)  # so that no half a moment is left
            self._timestamps_ns.append(timestamp_ns)
            raise
        self._timestamps_ns.append(timestamp_ns)

    def publish(self) -> None:
        """Give the drive its name, where a moment has been recorded."""
        if self._log is not None and self._timestamps_ns:
            self._log.publish(self._timestamps_ns)

    def _write(
        self,
        timestamp_ns: int,
        readings: Mapping[str, Any],
        targets: list[Target],
        city_SE3_ego: NDArray[np.float64],
    ) -> None:
        log = self._opened_log()
        boxes: dict[str, list[TrueBox]] = {}
        for view in self._rig.views:
            log.write_image(view.camera, timestamp_ns, pixels_of(readings[sensor_name(COLOURS, view.camera)])[..., :3])
            ids = self._ids(view, readings, targets)
            boxes[view.camera] = true_boxes(view, ids, targets, hidden_until_m=self._config.distance_m)
        scan = self._scan(readings[LIDAR])
        log.write_sweep(timestamp_ns, scan)
        near = [target for target in targets if target.distance_m <= self._config.distance_m]
        log.finish_moment(timestamp_ns, city_SE3_ego=city_SE3_ego, targets=near, boxes=boxes, scan=scan)

    def _opened_log(self) -> SimulatedLog:
        """Opened at the first moment, so that nothing is left where there is none."""
        if self._log is None:
            log = SimulatedLog(self.folder, self._about(), jpeg_quality=self._config.jpeg_quality)
            log.write_calibration(self._rig)
            self._log = log
        return self._log

    def _about(self) -> dict[str, object]:
        """What the drive says of itself. No other recording says the same, so none goes on where this one stops."""
        return {
            "recorded_from": f"CARLA {self._version.text}",
            "recording": str(self._recording),
            "settings": asdict(self._config),
        }

    def _ids(self, view: View, readings: Mapping[str, Any], targets: list[Target]) -> NDArray[np.int32]:
        tags = self._version.vehicle_tags
        if self._version.shows_actor_ids:
            return ids_from_instances(readings[sensor_name(INSTANCES, view.camera)], targets, tags)
        depth, semantics = (readings[sensor_name(kind, view.camera)] for kind in (DEPTH, SEMANTICS))
        return ids_from_depth(view, depth, semantics, targets, tags)

    def _scan(self, measurement: Any) -> Scan:
        """A sweep in the ego frame, without the points on the own car. CARLA measures all of it at one time."""
        points_m, strength = points_of(measurement.raw_data)
        xyz_m = points_m + np.array(self._rig.lidar_m)
        counts: list[int] = [measurement.get_point_count(channel) for channel in range(measurement.channels)]
        laser = np.repeat(np.arange(len(counts)), counts)
        if len(laser) != len(xyz_m):
            laser = np.zeros(len(xyz_m), dtype=np.int64)  # nothing needs it: better unknown than wrong
        box = self._borrowed.ego.bounding_box
        in_box_m = transform_points(invert_se3(actor_SE3_body(box)), xyz_m) - [0.0, 0.0, box.extent.z]
        half_m = np.array([box.extent.x, box.extent.y, box.extent.z]) + _OWN_CAR_MARGIN_M
        kept = ~(np.abs(in_box_m) <= half_m).all(axis=1)
        number = int(np.count_nonzero(kept))
        return Scan(
            xyz_m=xyz_m[kept],
            intensity=np.rint(np.clip(strength[kept], 0, 1) * 255).astype(np.uint8),
            laser_number=laser[kept].astype(np.uint8),
            offset_ns=np.zeros(number, dtype=np.int32),
            vehicle_id=np.zeros(number, dtype=np.int32),
        )


def _require_embree() -> None:
    """Before the server is touched: without it, no box could be written."""
    try:
        load_embree()
    except SimulationError as error:
        raise CarlaError(f"Recording from CARLA needs embreex. Install it: {INSTALL_COMMAND}") from error


def _failure(error: Exception, recorder: _Recorder, borrowed: BorrowedWorld) -> str:
    """What a recording that failed says: why, what is kept, and what could not be undone."""
    told = str(error) if isinstance(error, CarlaError) else f"CARLA failed: {error}."
    kept = [f"The {recorder.moments} moments recorded until then are in {recorder.folder}."] if recorder.moments else []
    return " ".join([told, *kept, *_not_restored(borrowed)])


def _not_restored(borrowed: BorrowedWorld) -> list[str]:
    if not borrowed.not_restored:
        return []
    return [f"The CARLA server could not be left as it was found: {'; '.join(borrowed.not_restored[:5])}. Restart it."]
