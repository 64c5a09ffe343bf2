"""The text files of the KITTI tracking benchmark: calibration, GPS/IMU readings ("oxts") and labels.

Formulas as in the benchmark's development kit. All is brought into the Velodyne's frame, which is the ego frame.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from labeler.drive.errors import DriveFileError
from labeler.drive.poses import poses_from_rows
from labeler.drive.types import Calibration, Poses, Truth, TruthBoxes2D, TruthBoxes3D
from labeler.geometry.se3 import invert_se3, se3, transform_points

_EARTH_RADIUS_M = 6378137.0
_RECTIFICATION = ("R_rect", "R0_rect")
_VELO_TO_CAMERA = ("Tr_velo_cam", "Tr_velo_to_cam")
_IMU_TO_VELO = ("Tr_imu_velo", "Tr_imu_to_velo")
_LABEL_FIELDS = 17
_OXTS_FIELDS = 6
_DONT_CARE = "DontCare"


@dataclass(frozen=True, eq=False)
class KittiCalibration:
    """``cameras`` by number; ``velo_SE3_rectified`` maps the rectified frame of camera 0, in which labels are given."""

    cameras: Mapping[int, Calibration]
    velo_SE3_rectified: NDArray[np.float64]
    velo_SE3_imu: NDArray[np.float64] | None


def read_calibration(path: Path) -> KittiCalibration:
    """Reads ``calib/<sequence>.txt`` in any of the spellings of its keys. DriveFileError when it lacks a part.

    The fourth column of a projection matrix P holds K times the offset of the camera from camera 0 in the rectified
    frame."""
    values = _keyed_numbers(path)
    rectification = _matrix(values, _RECTIFICATION, (3, 3), path)
    camera0_SE3_velo = _matrix(values, _VELO_TO_CAMERA, (3, 4), path)
    rectified_SE3_velo = se3(rectification, np.zeros(3)) @ np.vstack([camera0_SE3_velo, [0.0, 0.0, 0.0, 1.0]])
    cameras: dict[int, Calibration] = {}
    for number in range(4):
        if f"P{number}" not in values:
            continue
        projection = _matrix(values, (f"P{number}",), (3, 4), path)
        intrinsics = projection[:, :3].copy()
        if intrinsics[0, 0] <= 0 or intrinsics[1, 1] <= 0:
            raise DriveFileError(f"{path}: the focal lengths of P{number} must be positive.")
        camera_SE3_rectified = se3(np.eye(3), np.linalg.solve(intrinsics, projection[:, 3]))
        cameras[number] = Calibration(intrinsics, invert_se3(camera_SE3_rectified @ rectified_SE3_velo))
    has_imu = any(key in values for key in _IMU_TO_VELO)
    velo_SE3_imu = np.vstack([_matrix(values, _IMU_TO_VELO, (3, 4), path), [0.0, 0.0, 0.0, 1.0]]) if has_imu else None
    return KittiCalibration(cameras, invert_se3(rectified_SE3_velo), velo_SE3_imu)


def read_oxts(path: Path, velo_SE3_imu: NDArray[np.float64], *, period_ns: int, warnings: list[str]) -> Poses | None:
    """Reads ``oxts/<sequence>.txt``, a line per frame, into poses of the Velodyne.

    The city frame has x east, y north, z up and its origin where the IMU was first; latitude and longitude become
    metres by the Mercator projection scaled at the first latitude. DriveFileError when a line is no row of numbers."""
    rows = _rows(path)
    short = next((number for number, row in enumerate(rows, 1) if len(row) < _OXTS_FIELDS), None)
    if short is not None:
        raise DriveFileError(f"{path}: line {short} has {len(rows[short - 1])} fields, but at least 6 are needed.")
    try:
        values = np.array([row[:_OXTS_FIELDS] for row in rows], dtype=np.float64).reshape(-1, _OXTS_FIELDS)
    except ValueError as error:
        raise DriveFileError(f"{path} holds something that is no number: {error}.") from error
    finite = np.isfinite(values).all(axis=1)
    city_SE3_imu = np.full((len(values), 4, 4), np.nan)
    if finite.any():
        city_SE3_imu[finite] = _imu_poses(values[finite])
    timestamp_ns = np.arange(len(values), dtype=np.int64) * period_ns
    return poses_from_rows(timestamp_ns, city_SE3_imu @ invert_se3(velo_SE3_imu), source=str(path), warnings=warnings)


def read_truth_labels(
    path: Path, index_of: Mapping[int, int], calibration: KittiCalibration | None, *, camera: str
) -> Truth:
    """Reads ``label_02/<sequence>.txt``; ``index_of`` maps KITTI's frame number to that of the drive's frame.

    DontCare regions have no 3D box and an unknown distance (NaN). Without calibration there are no 3D boxes.
    DriveFileError when a line is malformed."""
    rows = [(index_of[_frame_number(row, number, path)], row) for number, row in enumerate(_rows(path), 1)
            if _frame_number(row, number, path) in index_of]  # fmt: skip
    try:
        values = np.array([row[6:_LABEL_FIELDS] for _, row in rows], dtype=np.float64).reshape(-1, _LABEL_FIELDS - 6)
    except ValueError as error:
        raise DriveFileError(f"{path} holds something that is no number: {error}.") from error
    frame_index = np.array([index for index, _ in rows], dtype=np.int32)
    uuid, category = tuple(row[1] for _, row in rows), tuple(row[2] for _, row in rows)
    cared = np.flatnonzero([name != _DONT_CARE for name in category])
    boxes_3d, distance_m = None, None
    if calibration is not None:
        center_m, size_m, yaw_rad = _boxes_in_velodyne_frame(values[cared], calibration.velo_SE3_rectified)
        boxes_3d = TruthBoxes3D(
            frame_index=frame_index[cared],
            track_uuid=tuple(uuid[row] for row in cared.tolist()),
            category=tuple(category[row] for row in cared.tolist()),
            center_m=center_m,
            size_m=size_m,
            yaw_rad=yaw_rad,
        )
        distance_m = np.full(len(rows), np.nan, dtype=np.float32)
        distance_m[cared] = np.linalg.norm(center_m[:, :2], axis=1)
    boxes_2d = TruthBoxes2D(
        frame_index=frame_index,
        camera=(camera,) * len(rows),
        track_uuid=uuid,
        category=category,
        xyxy_px=values[:, :4].astype(np.float32),
        distance_m=distance_m,
    )
    return Truth(boxes_2d, boxes_3d)


def _boxes_in_velodyne_frame(
    values: NDArray[np.float64], velo_SE3_rectified: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """(N, 3) centres, (N, 3) sizes and (N,) yaws of rows bbox(4) h w l x y z ry; x y z is the middle of the bottom."""
    height_m, width_m, length_m = values[:, 4], values[:, 5], values[:, 6]
    center_rectified_m = values[:, 7:10] - np.stack([0 * height_m, height_m / 2, 0 * height_m], axis=1)
    ry = values[:, 10]
    heading = np.stack([np.cos(ry), 0 * ry, -np.sin(ry)], axis=1) @ velo_SE3_rectified[:3, :3].T
    center_m = transform_points(velo_SE3_rectified, center_rectified_m)
    return center_m, np.stack([length_m, width_m, height_m], axis=1), np.arctan2(heading[:, 1], heading[:, 0])


def _imu_poses(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 4, 4) city_SE3_imu of rows latitude, longitude [degrees], altitude [m], roll, pitch, yaw [radians]."""
    latitude, longitude, altitude_m = values[:, 0], values[:, 1], values[:, 2]
    scale = np.cos(np.radians(latitude[0]))
    east_m = scale * _EARTH_RADIUS_M * np.radians(longitude)
    north_m = scale * _EARTH_RADIUS_M * np.log(np.tan(np.radians(90.0 + latitude) / 2))
    position_m = np.stack([east_m, north_m, altitude_m], axis=1)
    poses = np.tile(np.eye(4), (len(values), 1, 1))
    poses[:, :3, :3] = Rotation.from_euler("ZYX", values[:, [5, 4, 3]]).as_matrix()
    poses[:, :3, 3] = position_m - position_m[0]
    return poses


def _keyed_numbers(path: Path) -> dict[str, list[float]]:
    try:
        return {row[0].rstrip(":"): [float(text) for text in row[1:]] for row in _rows(path)}
    except ValueError as error:
        raise DriveFileError(f"{path} holds something that is no number: {error}.") from error


def _matrix(
    values: Mapping[str, list[float]], keys: tuple[str, ...], shape: tuple[int, int], path: Path
) -> NDArray[np.float64]:
    found = next((values[key] for key in keys if key in values), None)
    if found is None:
        raise DriveFileError(f"{path} lacks {' or '.join(keys)}; it has {', '.join(values) or 'nothing'}.")
    if len(found) != shape[0] * shape[1] or not np.isfinite(found).all():
        raise DriveFileError(
            f"{path}: {keys[0]} must be {shape[0] * shape[1]} finite numbers, got {len(found)} numbers."
        )
    return np.array(found).reshape(shape)


def _frame_number(row: list[str], line: int, path: Path) -> int:
    if len(row) < _LABEL_FIELDS:
        raise DriveFileError(f"{path}: line {line} has {len(row)} fields, but a label has {_LABEL_FIELDS}.")
    try:
        return int(row[0])
    except ValueError as error:
        raise DriveFileError(f"{path}: line {line} must begin with a frame number, not {row[0]}.") from error


def _rows(path: Path) -> list[list[str]]:
    """The fields of each line that is not blank."""
    try:
        return [fields for line in path.read_text(encoding="utf-8").splitlines() if (fields := line.split())]
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is no text"
        raise DriveFileError(f"{path} can't be read: {reason}.") from error
