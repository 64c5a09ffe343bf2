"""KITTI's text files, by hand-computed values."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from labeler.drive.errors import DriveFileError
from labeler.drive.kitti_text import read_calibration, read_oxts, read_truth_labels
from labeler.drive.types import Poses
from labeler.geometry.projection import project_points
from labeler.geometry.se3 import se3, yaw_of

_OBJECT_STYLE = """\
P2: 20 0 16 2 0 20 8 0 0 0 1 0
R0_rect: 1 0 0 0 1 0 0 0 1
Tr_velo_to_cam: 0 -1 0 0 0 0 -1 -0.1 1 0 0 -0.3
Tr_imu_to_velo: 1 0 0 -0.8 0 1 0 0.3 0 0 1 -0.8
"""
_TRACKING_STYLE = (
    _OBJECT_STYLE.replace("R0_rect:", "R_rect").replace("Tr_velo_to_cam:", "Tr_velo_cam").replace("_to_velo:", "_velo")
)


def _written(folder: Path, text: str) -> Path:
    path = folder / "0000.txt"
    path.write_text(text)
    return path


@pytest.mark.parametrize("text", [_OBJECT_STYLE, _TRACKING_STYLE, _TRACKING_STYLE.replace("R_rect", "R_rect:")])
def test_calibration_in_each_spelling(tmp_path: Path, text: str) -> None:
    calibration = read_calibration(_written(tmp_path, text))
    camera = calibration.cameras[2]
    assert camera.intrinsics.tolist() == [[20, 0, 16], [0, 20, 8], [0, 0, 1]]
    # 10.3 m ahead of the Velodyne, 1 m to the left, at its height: camera 0 sees it at (-1, -0.1, 10), and camera 2,
    # which stands 0.1 m to the left of camera 0, at (-0.9, -0.1, 10).
    pixels, depths_m = project_points(np.array([[10.3, 1.0, 0.0]]), camera.ego_SE3_camera, camera.intrinsics)
    assert pixels[0].tolist() == pytest.approx([16 - 20 * 0.09, 8 - 20 * 0.01])
    assert depths_m.tolist() == pytest.approx([10])
    assert calibration.velo_SE3_imu is not None
    assert calibration.velo_SE3_imu[:3, 3].tolist() == [-0.8, 0.3, -0.8]


def test_rectification_turns_before_projection(tmp_path: Path) -> None:
    turned = _OBJECT_STYLE.replace("R0_rect: 1 0 0 0 1 0 0 0 1", "R0_rect: 0 -1 0 1 0 0 0 0 1")
    camera = read_calibration(_written(tmp_path, turned)).cameras[2]
    # (-1, -0.1, 10) of camera 0 becomes (0.1, -1, 10), and camera 2 sees it at (0.2, -1, 10).
    pixels, _ = project_points(np.array([[10.3, 1.0, 0.0]]), camera.ego_SE3_camera, camera.intrinsics)
    assert pixels[0].tolist() == pytest.approx([16.4, 6])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("R0_rect", "R9"), "lacks R_rect or R0_rect; it has P2, R9"),
        (("0 0 1 0\n", "0 0 1\n"), "P2 must be 12 finite numbers, got 11"),
        (("-0.3", "nan"), "must be 12 finite numbers"),
        (("P2: 20", "P2: 0"), "focal lengths of P2 must be positive"),
        (("16", "sixteen"), "no number"),
    ],
)
def test_broken_calibrations_are_refused(tmp_path: Path, change: tuple[str, str], message: str) -> None:
    with pytest.raises(DriveFileError, match=message):
        read_calibration(_written(tmp_path, _OBJECT_STYLE.replace(*change)))


def _oxts(folder: Path, rows: list[list[float]], warnings: list[str]) -> Poses | None:
    text = "\n".join(" ".join(str(value) for value in [*row, *[0] * 24]) for row in rows)
    velo_SE3_imu = se3(np.eye(3), [-0.8, 0.3, -0.8])
    return read_oxts(_written(folder, text), velo_SE3_imu, period_ns=100, warnings=warnings)


def test_oxts_at_the_equator(tmp_path: Path) -> None:
    # A degree is 6378137 * pi / 180 = 111319.49 m there. The Velodyne stands at (0.8, -0.3, 0.8) from the IMU.
    poses = _oxts(tmp_path, [[0, 0, 50, 0, 0, 0], [1e-5, 2e-5, 51, 0, 0, math.pi / 2]], [])
    assert poses is not None
    assert poses.timestamp_ns.tolist() == [0, 100]
    assert poses.city_SE3_ego[0, :3, 3].tolist() == pytest.approx([0.8, -0.3, 0.8])
    # It has turned to the north: its x is the city's y.
    assert poses.city_SE3_ego[1, :3, 3].tolist() == pytest.approx([2.2263898 + 0.3, 1.1131949 + 0.8, 1.8], abs=1e-6)
    assert yaw_of(poses.city_SE3_ego[1]) == pytest.approx(math.pi / 2)


def test_oxts_shrinks_longitude_at_60_degrees_north(tmp_path: Path) -> None:
    poses = _oxts(tmp_path, [[60, 10, 0, 0, 0, 0], [60, 10.00002, 0, 0, 0, 0], [60.00001, 10, 0, 0, 0, 0]], [])
    assert poses is not None
    steps_m = poses.city_SE3_ego[1:, :3, 3] - poses.city_SE3_ego[0, :3, 3]
    np.testing.assert_allclose(steps_m, [[1.1131949, 0, 0], [0, 1.1131949, 0]], atol=1e-5)


def test_oxts_pitch_and_roll(tmp_path: Path) -> None:
    poses = _oxts(tmp_path, [[0, 0, 0, 0.1, 0, 0], [0, 0, 0, 0, 0.2, 0]], [])
    assert poses is not None
    assert poses.city_SE3_ego[0, 2, 1] == pytest.approx(math.sin(0.1))  # roll lifts the left side
    assert poses.city_SE3_ego[1, 2, 0] == pytest.approx(-math.sin(0.2))  # pitch lowers the nose


def test_an_oxts_line_that_is_not_finite_is_left_out(tmp_path: Path) -> None:
    warnings: list[str] = []
    poses = _oxts(tmp_path, [[0, 0, 0, 0, 0, 0], [math.nan, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]], warnings)
    assert poses is not None
    assert poses.timestamp_ns.tolist() == [0, 200]
    assert "left out 1 pose" in warnings[0]


_LABELS = """\
0 -1 DontCare -1 -1 -10 5 6 7 8 -1000 -1000 -1000 -10 -1 -1 -1
3 4 Car 0 0 1.2 10 20 30 40 1.5 2 4 2 1.65 10 0
3 9 Pedestrian 0 0 1.2 11 21 31 41 1.8 0.6 0.8 0 1.7 20 -1.5707963
"""


def test_labels(tmp_path: Path) -> None:
    calibration = read_calibration(_written(tmp_path, _OBJECT_STYLE))
    path = tmp_path / "labels.txt"
    path.write_text(_LABELS)
    truth = read_truth_labels(path, {0: 0, 3: 1}, calibration, camera="image_02")
    assert truth.boxes_2d is not None
    assert truth.boxes_3d is not None
    assert truth.boxes_2d.frame_index.tolist() == [0, 1, 1]
    assert truth.boxes_2d.category == ("DontCare", "Car", "Pedestrian")
    assert truth.boxes_2d.track_uuid == ("-1", "4", "9")
    assert truth.boxes_2d.xyxy_px[:2].tolist() == [[5, 6, 7, 8], [10, 20, 30, 40]]
    assert truth.boxes_2d.distance_m is not None
    assert math.isnan(truth.boxes_2d.distance_m[0])
    assert truth.boxes_2d.distance_m[1:].tolist() == pytest.approx([math.hypot(10.3, 2), 20.3])
    assert truth.boxes_3d.category == ("Car", "Pedestrian")
    # The car's middle is (2, 1.65 - 0.75, 10) in the rectified frame. It faces right, the pedestrian ahead.
    np.testing.assert_allclose(truth.boxes_3d.center_m, [[10.3, -2, -1.0], [20.3, 0, -0.9]])
    assert truth.boxes_3d.size_m.tolist() == [[4, 2, 1.5], [0.8, 0.6, 1.8]]
    assert truth.boxes_3d.yaw_rad.tolist() == pytest.approx([-math.pi / 2, 0], abs=1e-6)


def test_labels_without_calibration_are_2d(tmp_path: Path) -> None:
    truth = read_truth_labels(_written(tmp_path, _LABELS), {3: 0}, None, camera="image_02")
    assert truth.boxes_3d is None
    assert truth.boxes_2d is not None
    assert truth.boxes_2d.distance_m is None
    assert truth.boxes_2d.frame_index.tolist() == [0, 0]


def test_no_labels(tmp_path: Path) -> None:
    calibration = read_calibration(_written(tmp_path, _OBJECT_STYLE))
    path = tmp_path / "labels.txt"
    path.write_text("")
    truth = read_truth_labels(path, {0: 0}, calibration, camera="image_02")
    assert truth.boxes_3d is not None
    assert truth.boxes_3d.center_m.shape == (0, 3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0 1 Car 0 0", "line 1 has 5 fields, but a label has 17"),
        ("zero" + _LABELS[1:], "line 1 must begin with a frame number, not zero"),
        (_LABELS.replace(" 5 6 ", " five 6 "), "no number"),
    ],
)
def test_broken_labels_are_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(DriveFileError, match=message):
        read_truth_labels(_written(tmp_path, text), {0: 0, 3: 1}, None, camera="image_02")
