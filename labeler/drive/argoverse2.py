"""The native format: a log of the Argoverse 2 sensor dataset, https://argoverse.github.io/user-guide/.

LiDAR points lie in the ego frame already. Images are used as a pinhole's, without distortion, as the dataset's own
tools do; so the coefficients k1..k3 of the intrinsics are not read.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from labeler.drive.assembly import Recording, assemble
from labeler.drive.errors import DriveError, DriveFileError
from labeler.drive.feather import FeatherTable, read_feather
from labeler.drive.format import DriveFormat
from labeler.drive.listing import IMAGE_SUFFIXES, folders_in, list_numbered_files, some_of
from labeler.drive.poses import poses_from_rows, se3_from_rows
from labeler.drive.sweeps import checked_sweep
from labeler.drive.types import (
    Calibration,
    Camera,
    Drive,
    Frame,
    ImageFile,
    Poses,
    Sweep,
    SweepFile,
    Truth,
    TruthBoxes2D,
    TruthBoxes3D,
)

_POSE = ("qw", "qx", "qy", "qz", "tx_m", "ty_m", "tz_m")
_INTRINSICS = ("fx_px", "fy_px", "cx_px", "cy_px", "width_px", "height_px")
_BOX = ("x1_px", "y1_px", "x2_px", "y2_px")
_VISIBLE_BOX = tuple(f"visible_{column}" for column in _BOX)
_SIZE = ("length_m", "width_m", "height_m")
_POINTS = "num_interior_pts"


@dataclass(frozen=True)
class Argoverse2SweepReader:
    """Reads ``sensors/lidar/<timestamp_ns>.feather``: x, y, z in the ego frame and intensity, of any number type, and
    ``offset_ns`` where it is there."""

    def __call__(self, file: SweepFile) -> Sweep:
        table = read_feather(file.path, ("x", "y", "z", "intensity"))
        values = table.floats("x", "y", "z", "intensity").astype(np.float32)
        offset_ns = _offsets_ns(table) if table.has("offset_ns") else None
        return checked_sweep(file, values[:, :3], values[:, 3], offset_ns)


@dataclass(frozen=True)
class Argoverse2TruthReader:
    """Reads ``annotations.feather`` and ``annotations_2d.feather``. Rows of moments in no frame are left out.

    DriveFileError when one of them is there and can't be read."""

    root: Path

    def __call__(self, frames: tuple[Frame, ...]) -> Truth | None:
        in_3d, in_2d = self.root / "annotations.feather", self.root / "annotations_2d.feather"
        if not in_3d.exists() and not in_2d.exists():
            return None
        return Truth(
            boxes_2d=_truth_2d(in_2d, frames) if in_2d.exists() else None,
            boxes_3d=_truth_3d(in_3d, frames) if in_3d.exists() else None,
        )


def _matches(path: Path) -> bool:
    return (path / "sensors" / "cameras").is_dir() or (path / "sensors" / "lidar").is_dir()


def _open(path: Path, scene: str | None) -> Drive:
    if scene is not None and scene != path.name:
        raise DriveError(f"{path} is one Argoverse 2 log and has no scene named {scene}: leave the scene out.")
    warnings: list[str] = []
    sizes_px, calibrations = _read_calibration(path / "calibration", warnings)
    images = {name: list[ImageFile]() for name in sizes_px}
    for folder in folders_in(path / "sensors" / "cameras"):
        files = list_numbered_files(folder, IMAGE_SUFFIXES, warnings)
        images[folder.name] = [ImageFile(folder.name, timestamp_ns, file) for timestamp_ns, file in files]
    sweeps = list_numbered_files(path / "sensors" / "lidar", frozenset({".feather"}), warnings)
    recording = Recording(
        name=path.name,
        format=ARGOVERSE2.name,
        root=path,
        images=images,
        sizes_px=sizes_px,
        calibrations=calibrations,
        sweeps=[SweepFile(timestamp_ns, file) for timestamp_ns, file in sweeps],
        poses=_read_poses(path / "city_SE3_egovehicle.feather", warnings),
        read_sweep=Argoverse2SweepReader(),
        read_truth=Argoverse2TruthReader(path),
    )
    return assemble(recording, warnings)


def has_annotations_only(path: Path) -> bool:
    """Whether the folder is a log of which there are 3D annotations and a calibration, but no image."""
    images = (folder for folder in folders_in(path / "sensors" / "cameras") if any(folder.iterdir()))
    return (path / "annotations.feather").is_file() and (path / "calibration").is_dir() and next(images, None) is None


def open_annotated_log(path: Path) -> Drive:
    """A log without images as a drive: a frame for each moment of its annotations, without any sensor's reading.

    Its cameras are those of the calibration. DriveError when no camera has one, or a table can't be read."""
    warnings: list[str] = []
    sizes_px, calibrations = _read_calibration(path / "calibration", warnings)
    if not calibrations:
        raise DriveError(f"{path} has no camera with a usable calibration. {' '.join(warnings)}")
    times_ns = np.unique(read_feather(path / "annotations.feather", ("timestamp_ns",)).integers("timestamp_ns"))
    return Drive(
        name=path.name,
        format=ARGOVERSE2.name,
        root=path,
        cameras=tuple(Camera(name, *sizes_px[name], calibrations[name]) for name in sorted(calibrations)),
        frames=tuple(Frame(index, time_ns, {}, None) for index, time_ns in enumerate(times_ns.tolist())),
        poses=_read_poses(path / "city_SE3_egovehicle.feather", warnings),
        read_sweep=Argoverse2SweepReader(),
        read_truth=Argoverse2TruthReader(path),
        warnings=tuple(warnings),
    )


def _read_calibration(
    folder: Path, warnings: list[str]
) -> tuple[dict[str, tuple[int, int]], Mapping[str, Calibration]]:
    """Sizes of all cameras with intrinsics, and calibrations of those that have extrinsics too."""
    try:
        intrinsics = read_feather(folder / "intrinsics.feather", ("sensor_name", *_INTRINSICS))
        extrinsics = read_feather(folder / "egovehicle_SE3_sensor.feather", ("sensor_name", *_POSE))
        values, poses = intrinsics.floats(*_INTRINSICS), _se3(extrinsics)
    except DriveFileError as error:
        warnings.append(f"The calibration can't be used: {error}")
        return {}, {}
    sizes_px: dict[str, tuple[int, int]] = {}
    calibrations: dict[str, Calibration] = {}
    ego_SE3_sensor = dict(zip(extrinsics.strings("sensor_name"), poses, strict=True))
    broken: list[str] = []
    for name, row in zip(intrinsics.strings("sensor_name"), values, strict=True):
        fx, fy, cx, cy, width_px, height_px = row.tolist()
        ego_SE3_camera = ego_SE3_sensor.get(name, np.full((4, 4), np.nan))
        if not (np.isfinite(row).all() and fx > 0 and fy > 0 and width_px >= 1 and height_px >= 1):
            broken.append(name)
            continue
        sizes_px[name] = int(width_px), int(height_px)
        if np.isfinite(ego_SE3_camera).all():
            matrix = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
            calibrations[name] = Calibration(matrix, ego_SE3_camera)
        else:
            broken.append(name)
    if broken:
        warnings.append(f"In {folder}, numbers are missing or make no sense for {some_of(broken, at_most=10)}.")
    return sizes_px, calibrations


def _read_poses(file: Path, warnings: list[str]) -> Poses | None:
    if not file.exists():
        warnings.append(f"{file.name} is missing: the drive is labelled without ego poses.")
        return None
    try:
        table = read_feather(file, ("timestamp_ns", *_POSE))
        return poses_from_rows(table.integers("timestamp_ns"), _se3(table), source=file.name, warnings=warnings)
    except DriveFileError as error:
        warnings.append(f"The drive is labelled without ego poses: {error}")
        return None


def _offsets_ns(table: FeatherTable) -> NDArray[np.int32]:
    """(N,) when each point was measured, less the sweep's time; 0 where a cell is empty or off by more than seconds."""
    offset_ns = table.floats("offset_ns")[:, 0]
    with np.errstate(invalid="ignore"):
        usable = np.abs(offset_ns) < np.iinfo(np.int32).max
    return np.where(usable, offset_ns, 0).astype(np.int32)


def _se3(table: FeatherTable) -> NDArray[np.float64]:
    values = table.floats(*_POSE)
    return se3_from_rows(values[:, :4], values[:, 4:])


def _truth_3d(file: Path, frames: tuple[Frame, ...]) -> TruthBoxes3D:
    table = read_feather(file, ("timestamp_ns", "track_uuid", "category", *_SIZE, *_POSE))
    index_at = {frame.sweep.timestamp_ns if frame.sweep else frame.timestamp_ns: frame.index for frame in frames}
    frame_index = np.array([index_at.get(int(ns), -1) for ns in table.integers("timestamp_ns")], dtype=np.int32)
    ego_SE3_box = _se3(table)
    rows = np.flatnonzero((frame_index >= 0) & np.isfinite(ego_SE3_box).all(axis=(1, 2)))
    rotation = ego_SE3_box[rows, :3, :3]
    return TruthBoxes3D(
        frame_index=frame_index[rows],
        track_uuid=_taken(table.strings("track_uuid"), rows),
        category=_taken(table.strings("category"), rows),
        center_m=ego_SE3_box[rows, :3, 3],
        size_m=table.floats(*_SIZE)[rows],
        yaw_rad=np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0]),
        num_points=table.integers(_POINTS)[rows] if table.has(_POINTS) else None,
    )


def _truth_2d(file: Path, frames: tuple[Frame, ...]) -> TruthBoxes2D:
    table = read_feather(file, ("timestamp_ns", "camera", "track_uuid", "category", *_BOX))
    index_at = {(name, image.timestamp_ns): frame.index for frame in frames for name, image in frame.images.items()}
    cameras = table.strings("camera")
    moments = zip(cameras, table.integers("timestamp_ns").tolist(), strict=True)
    frame_index = np.array([index_at.get(moment, -1) for moment in moments], dtype=np.int32)
    rows = np.flatnonzero(frame_index >= 0)
    has_visible, has_distance = table.has(*_VISIBLE_BOX), table.has("distance_m")
    has_share, has_pixels = table.has("visible_share"), table.has("visible_pixels")
    return TruthBoxes2D(
        frame_index=frame_index[rows],
        camera=_taken(cameras, rows),
        track_uuid=_taken(table.strings("track_uuid"), rows),
        category=_taken(table.strings("category"), rows),
        xyxy_px=table.floats(*_BOX)[rows].astype(np.float32),
        visible_xyxy_px=table.floats(*_VISIBLE_BOX)[rows].astype(np.float32) if has_visible else None,
        distance_m=table.floats("distance_m")[rows, 0].astype(np.float32) if has_distance else None,
        visible_share=table.floats("visible_share")[rows, 0].astype(np.float32) if has_share else None,
        visible_pixels=table.integers("visible_pixels")[rows].astype(np.int32) if has_pixels else None,
    )


def _taken(values: tuple[str, ...], rows: NDArray[np.intp]) -> tuple[str, ...]:
    return tuple(values[int(row)] for row in rows)


ARGOVERSE2 = DriveFormat(
    name="argoverse2",
    looked_for="a folder sensors/cameras/<camera> with images named <timestamp_ns>.jpg",
    matches=_matches,
    open=_open,
)
