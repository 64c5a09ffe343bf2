"""Writes a simulated drive in the native format, a log of the Argoverse 2 sensor dataset
(https://argoverse.github.io/user-guide/datasets/sensor.html), one moment after the other.

A log grows in a hidden folder beside its final place and gets its name when it is whole. Each moment ends with a small
file that says that all of it is there, so that a stopped simulation can go on behind its last whole moment, and no
table has to be held in memory. Points are stored as float16 as in Argoverse 2: in steps of 3 cm at 50 m and of 6 cm
beyond 64 m.
"""

import errno
import json
import shutil
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from labeler.drive import SIMULATION_FILE
from labeler.geometry.se3 import se3
from labeler.simulation.errors import SimulationError
from labeler.simulation.lidar import Scan
from labeler.simulation.rig import Rig
from labeler.simulation.truth import Target, TrueBox, points_inside

_TABLES = ("annotations", "annotations_2d", "city_SE3_egovehicle")
"""A moment's tables in the order in which they are written; the last one marks the moment as whole."""
_POINT_MARGIN_M = 0.1
ARGOVERSE2_CATEGORY = {
    "car": "REGULAR_VEHICLE",
    "truck": "TRUCK",
    "bus": "BUS",
    "motorcycle": "MOTORCYCLE",
}
"""The data set's name for each kind of vehicle. Boxes in images, which it does not have, keep our own."""


class SimulatedLog:
    """A log on its way to ``folder``. ``about`` says what is simulated: a log of the same that was stopped goes on.

    SimulationError when ``folder`` is there already, or when nothing can be written there."""

    def __init__(self, folder: Path, about: Mapping[str, object], *, jpeg_quality: int) -> None:
        self._folder = folder.absolute()
        self._partial = self._folder.with_name(f".{self._folder.name}.partial")
        self._parts = self._partial / "parts"
        self._jpeg_quality = jpeg_quality
        require_free(folder)
        text = json.dumps(about, indent=2) + "\n"
        with self._writing():
            known = self._partial / SIMULATION_FILE
            if self._partial.exists() and not (known.exists() and known.read_text("utf-8") == text):
                shutil.rmtree(self._partial)
            self._parts.mkdir(parents=True, exist_ok=True)
            known.write_text(text, encoding="utf-8")

    def has(self, timestamp_ns: int) -> bool:
        """Whether all of a moment has been written."""
        return self._part(_TABLES[-1], timestamp_ns).exists()

    def write_image(self, camera: str, timestamp_ns: int, image: NDArray[np.uint8]) -> None:
        """An (H, W, 3) image in the order blue, green, red."""
        encoded, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, self._jpeg_quality])
        if not encoded:
            raise SimulationError(f"The image of camera {camera} could not be encoded as JPEG.")
        self._write_file(self._partial / "sensors" / "cameras" / camera / f"{timestamp_ns}.jpg", data.tobytes())

    def write_semantic(self, camera: str, timestamp_ns: int, semantic: NDArray[np.uint8]) -> None:
        """An (H, W) image of a ``Semantic`` a pixel, as PNG."""
        encoded, data = cv2.imencode(".png", semantic)
        if not encoded:
            raise SimulationError(f"The classes of camera {camera} could not be encoded as PNG.")
        self._write_file(self._partial / "semantic" / camera / f"{timestamp_ns}.png", data.tobytes())

    def write_sweep(self, timestamp_ns: int, scan: Scan) -> None:
        xyz_m = scan.xyz_m.astype(np.float16)
        columns = {axis: xyz_m[:, index] for index, axis in enumerate("xyz")}
        columns |= {"intensity": scan.intensity, "laser_number": scan.laser_number, "offset_ns": scan.offset_ns}
        self._write_table(self._partial / "sensors" / "lidar" / f"{timestamp_ns}.feather", _table(columns))

    def write_calibration(self, rig: Rig) -> None:
        folder, views = self._partial / "calibration", rig.views
        intrinsics = np.array([view.intrinsics for view in views])
        self._write_table(
            folder / "intrinsics.feather",
            _table(
                {
                    "sensor_name": [view.camera for view in views],
                    "fx_px": intrinsics[:, 0, 0],
                    "fy_px": intrinsics[:, 1, 1],
                    "cx_px": intrinsics[:, 0, 2],
                    "cy_px": intrinsics[:, 1, 2],
                    "k1": np.zeros(len(views)),
                    "k2": np.zeros(len(views)),
                    "k3": np.zeros(len(views)),
                    "height_px": np.array([view.height_px for view in views], dtype=np.int64),
                    "width_px": np.array([view.width_px for view in views], dtype=np.int64),
                }
            ),
        )
        poses = [*(view.ego_SE3_camera for view in views), se3(np.eye(3), rig.lidar_m)]
        names = [*(view.camera for view in views), "up_lidar"]
        self._write_table(folder / "egovehicle_SE3_sensor.feather", _table({"sensor_name": names} | _pose(poses)))

    def finish_moment(
        self,
        timestamp_ns: int,
        *,
        city_SE3_ego: NDArray[np.float64],
        targets: Sequence[Target],
        boxes: Mapping[str, Sequence[TrueBox]] | None,
        scan: Scan,
    ) -> None:
        """The truth of a moment, after its images and its sweep. ``boxes`` are those of each camera, None where there
        are no images: then the log has no table of them."""
        tables = (
            _annotations(timestamp_ns, targets, scan),
            None if boxes is None else _annotations_2d(timestamp_ns, boxes),
            _table({"timestamp_ns": np.array([timestamp_ns], dtype=np.int64)} | _pose([city_SE3_ego])),
        )
        for name, table in zip(_TABLES, tables, strict=True):
            if table is not None:
                self._write_table(self._part(name, timestamp_ns), table)

    def publish(self, timestamps_ns: Sequence[int]) -> None:
        """Join the tables of all moments, and give the log its name. SimulationError when a moment is missing."""
        missing = [timestamp_ns for timestamp_ns in timestamps_ns if not self.has(timestamp_ns)]
        if missing:
            raise SimulationError(f"{len(missing)} of {len(timestamps_ns)} moments have not been written.")
        for name in _TABLES:
            if self._part(name, timestamps_ns[0]).exists():
                self._join(name, timestamps_ns)
        with self._writing():
            shutil.rmtree(self._parts)
            self._partial.rename(self._folder)

    def _join(self, name: str, timestamps_ns: Sequence[int]) -> None:
        """One file of a table's parts, of which never more than one is in memory."""
        with self._writing(), _opened(self._part(name, timestamps_ns[0])) as first:
            schema = first.schema
            with pa.ipc.new_file(str(self._partial / f"{name}.feather"), schema, options=_options()) as writer:
                for timestamp_ns in timestamps_ns:
                    with _opened(self._part(name, timestamp_ns)) as part:
                        writer.write_table(part.read_all())

    def _part(self, name: str, timestamp_ns: int) -> Path:
        return self._parts / f"{timestamp_ns}.{name}.feather"

    def _write_file(self, file: Path, content: bytes) -> None:
        with self._writing():
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(content)

    def _write_table(self, file: Path, table: pa.Table) -> None:
        temporary = file.with_name(f".{file.name}.tmp")
        with self._writing():
            file.parent.mkdir(parents=True, exist_ok=True)
            with pa.ipc.new_file(str(temporary), table.schema, options=_options()) as writer:
                writer.write_table(table)
            temporary.replace(file)

    @contextmanager
    def _writing(self) -> Generator[None]:
        """Turns what the system says into what a user can do."""
        try:
            yield
        except OSError as error:
            if error.errno == errno.ENOSPC:
                raise SimulationError(
                    f"No space is left for {self._folder}. Free some; the same command then goes on from here."
                ) from error
            raise SimulationError(f"{self._folder} can't be written: {error}.") from error


def require_free(folder: Path) -> None:
    """SimulationError when there is something at ``folder`` already."""
    if folder.exists():
        raise SimulationError(f"{folder} is there already. Choose another folder, or delete it first.")


def _annotations(timestamp_ns: int, targets: Sequence[Target], scan: Scan) -> pa.Table:
    centers = [target.ego_SE3_body @ se3(np.eye(3), [0.0, 0.0, target.size_m[2] / 2]) for target in targets]
    sizes_m = np.array([target.size_m for target in targets], dtype=np.float64).reshape(-1, 3)
    inside = [int(points_inside(target, scan.xyz_m, margin_m=_POINT_MARGIN_M).sum()) for target in targets]
    return _table(
        {
            "timestamp_ns": np.full(len(targets), timestamp_ns, dtype=np.int64),
            "track_uuid": pa.array([target.track_uuid for target in targets], pa.string()),
            "category": pa.array([ARGOVERSE2_CATEGORY[target.category] for target in targets], pa.string()),
            "length_m": sizes_m[:, 0],
            "width_m": sizes_m[:, 1],
            "height_m": sizes_m[:, 2],
        }
        | _pose(centers)
        | {"num_interior_pts": np.array(inside, dtype=np.int64)}
    )


def _annotations_2d(timestamp_ns: int, boxes: Mapping[str, Sequence[TrueBox]]) -> pa.Table:
    rows = [(camera, box) for camera, of_camera in boxes.items() for box in of_camera]
    whole = np.array([box.whole_px for _, box in rows], dtype=np.float64).reshape(-1, 4)
    visible = np.array([box.visible_px for _, box in rows], dtype=np.float64).reshape(-1, 4)
    names = ("x1_px", "y1_px", "x2_px", "y2_px")
    return _table(
        {
            "timestamp_ns": np.full(len(rows), timestamp_ns, dtype=np.int64),
            "camera": pa.array([camera for camera, _ in rows], pa.string()),
            "track_uuid": pa.array([box.target.track_uuid for _, box in rows], pa.string()),
            "category": pa.array([box.target.category for _, box in rows], pa.string()),
        }
        | {name: whole[:, index].astype(np.float32) for index, name in enumerate(names)}
        | {f"visible_{name}": visible[:, index].astype(np.float32) for index, name in enumerate(names)}
        | {
            "visible_share": np.array([box.visible_share for _, box in rows], dtype=np.float32),
            "visible_pixels": np.array([box.visible_pixels for _, box in rows], dtype=np.int32),
            "distance_m": np.array([box.target.distance_m for _, box in rows], dtype=np.float32),
        }
    )


def _pose(poses: Sequence[NDArray[np.float64]]) -> dict[str, Any]:
    """Columns of (4, 4) poses: a quaternion, scalar first, and a translation."""
    matrices = np.array(poses, dtype=np.float64).reshape(-1, 4, 4)
    xyzw = Rotation.from_matrix(matrices[:, :3, :3]).as_quat() if len(matrices) else np.zeros((0, 4))
    columns: dict[str, Any] = {name: xyzw[:, index] for name, index in (("qw", 3), ("qx", 0), ("qy", 1), ("qz", 2))}
    return columns | {f"t{axis}_m": matrices[:, index, 3] for index, axis in enumerate("xyz")}


@contextmanager
def _opened(file: Path) -> Generator[pa.ipc.RecordBatchFileReader]:
    with pa.OSFile(str(file), "r") as stream, pa.ipc.open_file(stream) as reader:
        yield reader


def _options() -> pa.ipc.IpcWriteOptions:
    return pa.ipc.IpcWriteOptions(compression="zstd")


def _table(columns: Mapping[str, Any]) -> pa.Table:
    return pa.Table.from_pydict(dict(columns))
