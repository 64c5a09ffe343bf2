"""Small drives on disk, written file by file, so that a test can break one thing at a time."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pyarrow as pa
import pytest
from pyarrow import ipc

WIDTH_PX, HEIGHT_PX = 32, 16
START_NS = 1_000_000_000_000
PERIOD_NS = 100_000_000
_CAMERAS = ("ring_front_center", "ring_rear")
# The camera's x is the ego's -y, its y the ego's -z, its z the ego's x.
_LOOKS_AHEAD = {"qw": 0.5, "qx": -0.5, "qy": 0.5, "qz": -0.5}

WriteImage = Callable[..., Path]
WriteTable = Callable[[Path, Mapping[str, Any]], Path]


def _write_image(path: Path, width_px: int = WIDTH_PX, height_px: int = HEIGHT_PX, *, grey: bool = False) -> Path:
    rng = np.random.default_rng(0)
    shape = (height_px, width_px) if grey else (height_px, width_px, 3)
    encoded = cv2.imencode(path.suffix, rng.integers(0, 255, shape, dtype=np.uint8))[1]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(encoded.tobytes())
    return path


def _write_table(path: Path, columns: Mapping[str, Any]) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    table = pa.table(dict(columns))
    with pa.OSFile(str(path), "w") as stream, ipc.new_file(stream, table.schema) as writer:
        writer.write_table(table)
    return path


@pytest.fixture(scope="session")
def write_image() -> WriteImage:
    """``write_image(path, width_px, height_px, grey=...)``: a small random image."""
    return _write_image


@pytest.fixture(scope="session")
def write_table() -> WriteTable:
    """``write_table(path, columns)``: a feather file."""
    return _write_table


@pytest.fixture
def argoverse2_log(tmp_path: Path) -> Path:
    """Two cameras and a LiDAR, three frames at 10 Hz; images 10 ms after the sweep."""
    root = tmp_path / "a log"
    times_ns = [START_NS + index * PERIOD_NS for index in range(3)]
    for camera in _CAMERAS:
        for timestamp_ns in times_ns:
            _write_image(root / "sensors" / "cameras" / camera / f"{timestamp_ns + 10_000_000}.jpg")
    for timestamp_ns in times_ns:
        points = {name: np.array([1, 2, 3], dtype=np.float16) for name in "xyz"}
        columns = {**points, "intensity": np.array([7, 8, 9], dtype=np.uint8), "offset_ns": [0, 1, 2]}
        _write_table(root / "sensors" / "lidar" / f"{timestamp_ns}.feather", columns)
    names = list(_CAMERAS)
    _write_table(
        root / "calibration" / "intrinsics.feather",
        {"sensor_name": names, "fx_px": [20.0, 20.0], "fy_px": [20.0, 20.0], "cx_px": [16.0, 16.0],
         "cy_px": [8.0, 8.0], "k1": [0.1, 0.1], "width_px": [WIDTH_PX] * 2, "height_px": [HEIGHT_PX] * 2},
    )  # fmt: skip
    _write_table(
        root / "calibration" / "egovehicle_SE3_sensor.feather",
        {"sensor_name": [*names, "up_lidar"], **{key: [value] * 3 for key, value in _LOOKS_AHEAD.items()},
         "tx_m": [1.0, -1.0, 0.0], "ty_m": [0.0] * 3, "tz_m": [1.5] * 3},
    )  # fmt: skip
    _write_table(root / "city_SE3_egovehicle.feather", pose_columns(times_ns))
    return root


def pose_columns(times_ns: Sequence[int]) -> dict[str, Any]:
    """The car drives along x by 1 m per row, and does not turn."""
    count = len(times_ns)
    zeros = [0.0] * count
    return {"timestamp_ns": list(times_ns), "qw": [1.0] * count, "qx": zeros, "qy": zeros, "qz": zeros,
            "tx_m": [float(row) for row in range(count)], "ty_m": zeros, "tz_m": zeros}  # fmt: skip


@pytest.fixture(scope="session")
def poses_along_x() -> Callable[[Sequence[int]], dict[str, Any]]:
    """``poses_along_x(times_ns)``: the columns of a pose table."""
    return pose_columns


KITTI_CALIBRATION = """\
P0: 20 0 16 0 0 20 8 0 0 0 1 0
P1: 20 0 16 -10 0 20 8 0 0 0 1 0
P2: 20 0 16 2 0 20 8 0 0 0 1 0
P3: 20 0 16 -8 0 20 8 0 0 0 1 0
R_rect 1 0 0 0 1 0 0 0 1
Tr_velo_cam 0 -1 0 0 0 0 -1 -0.1 1 0 0 -0.3
Tr_imu_velo 1 0 0 -0.8 0 1 0 0.3 0 0 1 -0.8
"""


@pytest.fixture
def kitti_root(tmp_path: Path) -> Path:
    """One sequence with camera 2 and Velodyne, frames 0 to 4; the Velodyne's frame 2 is missing."""
    root = tmp_path / "kitti"
    split = root / "training"
    for number in range(5):
        _write_image(split / "image_02" / "0007" / f"{number:06d}.png")
        if number != 2:
            file = split / "velodyne" / "0007" / f"{number:06d}.bin"
            file.parent.mkdir(parents=True, exist_ok=True)
            np.array([[1, 2, 3, 0.5], [4, 5, 6, 0.25]], dtype="<f4").tofile(file)
    (split / "calib").mkdir()
    (split / "calib" / "0007.txt").write_text(KITTI_CALIBRATION)
    return root


@pytest.fixture
def nuscenes_root(tmp_path: Path) -> Path:
    """Two scenes; scene-0002 has two key frames and two sweeps between, a camera and a LiDAR, and one annotation.

    The car stands at (100, 200, 0), its x axis towards the global y. The LiDAR stands 1 m up, its x towards the
    ego's -y."""
    root = tmp_path / "nuscenes"
    quarter_left = [0.7071067811865476, 0.0, 0.0, 0.7071067811865476]
    quarter_right = [0.7071067811865476, 0.0, 0.0, -0.7071067811865476]
    readings: list[dict[str, Any]] = []
    poses: list[dict[str, Any]] = []
    for index, (sample, key_frame) in enumerate([("s1", True), ("s1", False), ("s2", False), ("s2", True)]):
        time_us = 5_000_000 + index * 50_000
        folder = "samples" if key_frame else "sweeps"
        image = f"{folder}/CAM_FRONT/{time_us - 5000}.jpg"
        sweep = f"{folder}/LIDAR_TOP/{time_us}.pcd.bin"
        _write_image(root / image)
        (root / sweep).parent.mkdir(parents=True, exist_ok=True)
        np.array([[10, 0, 0, 30, 1], [0, 20, 1, 40, 2]], dtype="<f4").tofile(root / sweep)
        for sensor, name, at_us in (("cs_cam", image, time_us - 5000), ("cs_lidar", sweep, time_us)):
            token = f"{sensor}{index}"
            size = {"width": WIDTH_PX, "height": HEIGHT_PX} if sensor == "cs_cam" else {"width": 0, "height": 0}
            reading = {"token": token, "sample_token": sample, "ego_pose_token": token, "timestamp": at_us}
            reading |= {"calibrated_sensor_token": sensor, "is_key_frame": key_frame, "filename": name, **size}
            readings.append(reading)
            poses.append({"token": token, "timestamp": at_us, "rotation": quarter_left, "translation": [100, 200, 0]})
    readings.reverse()  # the tables are in no order
    other = {**readings[0], "token": "other", "sample_token": "s9", "ego_pose_token": "other"}
    tables = {
        "scene": [{"token": "A", "name": "scene-0001"}, {"token": "B", "name": "scene-0002"}],
        "sample": [{"token": "s9", "scene_token": "A"}, *({"token": t, "scene_token": "B"} for t in ("s1", "s2"))],
        "sample_data": [other, *readings],
        "sensor": [{"token": "cam", "channel": "CAM_FRONT", "modality": "camera"},
                   {"token": "lidar", "channel": "LIDAR_TOP", "modality": "lidar"}],
        "calibrated_sensor": [
            {"token": "cs_cam", "sensor_token": "cam", "rotation": [0.5, -0.5, 0.5, -0.5], "translation": [2, 0, 1.5],
             "camera_intrinsic": [[20, 0, 16], [0, 20, 8], [0, 0, 1]]},
            {"token": "cs_lidar", "sensor_token": "lidar", "rotation": quarter_right, "translation": [1, 0, 1],
             "camera_intrinsic": []},
        ],
        "ego_pose": poses,
        "category": [{"token": "c", "name": "vehicle.car"}],
        "instance": [{"token": "i", "category_token": "c"}],
        "sample_annotation": [{"token": "a", "sample_token": "s2", "instance_token": "i", "size": [2, 4, 1.5],
                               "translation": [90, 230, 1], "rotation": [1, 0, 0, 0]}],
    }  # fmt: skip
    (root / "v1.0-mini").mkdir()
    for name, rows in tables.items():
        (root / "v1.0-mini" / f"{name}.json").write_text(json.dumps(rows, indent=0))
    return root
