"""nuScenes: a scene of a small set of tables."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from labeler.drive import DriveError, open_drive
from labeler.geometry.se3 import yaw_of


def _edit(root: Path, table: str, change: Callable[[list[dict[str, Any]]], list[dict[str, Any]]]) -> None:
    path = root / "v1.0-mini" / f"{table}.json"
    path.write_text(json.dumps(change(json.loads(path.read_text()))))


def test_key_frames_and_sweeps_of_one_scene(nuscenes_root: Path) -> None:
    drive = open_drive(nuscenes_root, scene="scene-0002")
    assert (drive.name, drive.format) == ("scene-0002", "nuscenes")
    assert [frame.timestamp_ns for frame in drive.frames] == [5_000_000_000 + i * 50_000_000 for i in range(4)]
    assert drive.frames[0].images["CAM_FRONT"].timestamp_ns == 4_995_000_000
    assert [frame.images["CAM_FRONT"].path.parent.parent.name for frame in drive.frames] == [
        "samples", "sweeps", "sweeps", "samples",
    ]  # fmt: skip
    assert [(camera.name, camera.width_px, camera.height_px) for camera in drive.cameras] == [("CAM_FRONT", 32, 16)]
    assert drive.cameras[0].calibration is not None
    assert drive.cameras[0].calibration.ego_SE3_camera[:3, 3].tolist() == [2, 0, 1.5]
    assert drive.warnings == ()


def test_poses_are_in_order_of_time(nuscenes_root: Path) -> None:
    poses = open_drive(nuscenes_root, scene="scene-0002").poses
    assert poses is not None
    assert len(poses.timestamp_ns) == 8  # one per reading
    assert poses.city_SE3_ego[0, :3, 3].tolist() == [100, 200, 0]
    assert yaw_of(poses.city_SE3_ego[0]) == pytest.approx(math.pi / 2)


def test_sweeps_are_in_the_ego_frame(nuscenes_root: Path) -> None:
    drive = open_drive(nuscenes_root, scene="scene-0002")
    assert drive.frames[0].sweep is not None
    sweep = drive.read_sweep(drive.frames[0].sweep)
    np.testing.assert_allclose(sweep.xyz_m, [[1, -10, 1], [21, 0, 2]], atol=1e-5)
    assert sweep.intensity.tolist() == [30, 40]


def test_truth_is_moved_from_the_global_frame(nuscenes_root: Path) -> None:
    drive = open_drive(nuscenes_root, scene="scene-0002")
    truth = drive.read_truth(drive.frames)
    assert truth is not None
    assert truth.boxes_2d is None
    boxes = truth.boxes_3d
    assert boxes is not None
    assert boxes.frame_index.tolist() == [3]
    assert (boxes.track_uuid, boxes.category) == (("i",), ("vehicle.car",))
    # From (100, 200, 0), (90, 230, 1) is (-10, 30, 1): 30 m ahead of a car that faces y, and 10 m to its left.
    np.testing.assert_allclose(boxes.center_m, [[30, 10, 1]], atol=1e-9)
    assert boxes.size_m.tolist() == [[4, 2, 1.5]]
    assert boxes.yaw_rad.tolist() == pytest.approx([-math.pi / 2])


@pytest.mark.parametrize("table", ["sample_annotation", "instance", "category"])
def test_without_truth_tables_there_is_no_truth(nuscenes_root: Path, table: str) -> None:
    (nuscenes_root / "v1.0-mini" / f"{table}.json").unlink()
    drive = open_drive(nuscenes_root, scene="scene-0002")
    assert drive.read_truth(drive.frames) is None


def test_several_scenes_must_be_named(nuscenes_root: Path) -> None:
    with pytest.raises(DriveError, match=r"2 nuScenes scenes: scene-0001, scene-0002\. Name the one"):
        open_drive(nuscenes_root)
    with pytest.raises(DriveError, match=r"no nuScenes scene named scene-0099\..*scene-0001, scene-0002"):
        open_drive(nuscenes_root, scene="scene-0099")
    many = [{"token": f"T{index}", "name": f"scene-{index:04d}"} for index in range(850)]
    _edit(nuscenes_root, "scene", lambda _: many)
    with pytest.raises(DriveError, match=r"850 nuScenes scenes: scene-0000, .*scene-0019 and 830 more"):
        open_drive(nuscenes_root)


def test_the_only_scene_needs_no_name(nuscenes_root: Path) -> None:
    _edit(nuscenes_root, "scene", lambda rows: rows[1:])
    assert open_drive(nuscenes_root).name == "scene-0002"


def test_files_that_are_not_there_are_counted(nuscenes_root: Path) -> None:
    for path in (nuscenes_root / "sweeps" / "CAM_FRONT").iterdir():
        path.unlink()
    drive = open_drive(nuscenes_root, scene="scene-0002")
    assert len(drive.frames) == 2
    assert drive.warnings == (
        "CAM_FRONT: 2 of 4 files that sample_data names are missing or empty: 5045000.jpg, 5095000.jpg.",
        "Left out 2 LiDAR sweeps that no image is near to (2 of 4).",
    )


def test_repeated_readings_are_skipped(nuscenes_root: Path) -> None:
    _edit(nuscenes_root, "sample_data", lambda rows: [*rows, *[row for row in rows if row["token"] == "cs_cam1"]])
    drive = open_drive(nuscenes_root, scene="scene-0002")
    assert [len(frame.images) for frame in drive.frames] == [1, 1, 1, 1]
    assert drive.warnings == ("CAM_FRONT: skipped 1 file of repeated times: 5045000.jpg.",)


def test_without_the_lidars_calibration_there_is_no_lidar(nuscenes_root: Path) -> None:
    _edit(nuscenes_root, "calibrated_sensor", lambda rows: rows[:1])
    drive = open_drive(nuscenes_root, scene="scene-0002")
    assert not drive.has_lidar
    assert len(drive.frames) == 4
    assert "No usable calibration of LIDAR_TOP" in drive.warnings[0]


def test_a_camera_with_broken_intrinsics_is_labelled_in_2d(nuscenes_root: Path) -> None:
    _edit(nuscenes_root, "calibrated_sensor", lambda rows: [{**rows[0], "camera_intrinsic": []}, rows[1]])
    drive = open_drive(nuscenes_root, scene="scene-0002")
    assert drive.cameras[0].calibration is None
    assert "No usable calibration for CAM_FRONT" in drive.warnings[0]


def test_a_missing_table_is_named(nuscenes_root: Path) -> None:
    (nuscenes_root / "v1.0-mini" / "ego_pose.json").unlink()
    with pytest.raises(DriveError, match=r"lacks ego_pose\.json"):
        open_drive(nuscenes_root)


def test_a_missing_field_is_named(nuscenes_root: Path) -> None:
    _edit(nuscenes_root, "sensor", lambda rows: [{"token": row["token"]} for row in rows])
    with pytest.raises(DriveError, match="a row lacks the field 'channel'"):
        open_drive(nuscenes_root, scene="scene-0002")


def test_a_scene_without_files_says_why(nuscenes_root: Path) -> None:
    for path in [*nuscenes_root.glob("samples/*/*"), *nuscenes_root.glob("sweeps/*/*")]:
        path.unlink()
    with pytest.raises(DriveError, match=r"no camera has an image.*4 of 4 files"):
        open_drive(nuscenes_root, scene="scene-0002")
