"""KITTI tracking sequences: layout and frames. The text files are tested in test_kitti_text."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from labeler.drive import DriveError, open_drive


@pytest.mark.parametrize("below", [".", "training"])  # the root, or the split itself
def test_frames_keep_their_numbers(kitti_root: Path, below: str) -> None:
    drive = open_drive(kitti_root / below)
    assert (drive.name, drive.format) == ("kitti_0007", "kitti")
    assert [(camera.name, camera.width_px, camera.height_px) for camera in drive.cameras] == [("image_02", 32, 16)]
    assert drive.cameras[0].calibration is not None
    assert [frame.timestamp_ns for frame in drive.frames] == [number * 100_000_000 for number in range(5)]
    assert [frame.sweep is not None for frame in drive.frames] == [True, True, False, True, True]
    assert drive.poses is None
    assert drive.warnings == ()


def test_a_missing_image_leaves_its_frame_out(kitti_root: Path) -> None:
    (kitti_root / "training" / "image_02" / "0007" / "000001.png").unlink()
    drive = open_drive(kitti_root)
    assert [frame.timestamp_ns // 100_000_000 for frame in drive.frames] == [0, 2, 3, 4]
    assert drive.warnings == ("Left out 1 LiDAR sweep that no image is near to (1 of 4).",)


def test_both_colour_cameras(kitti_root: Path) -> None:
    images = kitti_root / "training" / "image_02"
    shutil.copytree(images, images.with_name("image_03"))
    drive = open_drive(kitti_root)
    assert [camera.name for camera in drive.cameras] == ["image_02", "image_03"]
    # P2 and P3 put the cameras at 0.1 m and -0.4 m along x of the rectified frame, thus 0.5 m apart along the ego's y.
    positions = [c.calibration.ego_SE3_camera[:3, 3].tolist() for c in drive.cameras if c.calibration is not None]
    assert positions[0] == pytest.approx([0.3, 0.1, -0.1])
    assert positions[1] == pytest.approx([0.3, -0.4, -0.1])


@pytest.mark.parametrize(
    ("content", "warning"),
    [(None, "can't be read"), ("P2: 1 2 3", "lacks R_rect or R0_rect"), ("P2: a b c", "no number")],
)
def test_without_calibration_it_is_labelled_in_2d(kitti_root: Path, content: str | None, warning: str) -> None:
    file = kitti_root / "training" / "calib" / "0007.txt"
    file.unlink()
    if content:
        file.write_text(content)
    drive = open_drive(kitti_root)
    assert drive.cameras[0].calibration is None
    assert warning in drive.warnings[0]
    assert drive.has_lidar


def test_poses_come_from_oxts(kitti_root: Path) -> None:
    folder = kitti_root / "training" / "oxts"
    folder.mkdir()
    (folder / "0007.txt").write_text("0 0 100 0 0 0 9 9\n0 1e-5 100 0 0 0 9 9\n")
    poses = open_drive(kitti_root).poses
    assert poses is not None
    assert poses.timestamp_ns.tolist() == [0, 100_000_000]
    assert poses.city_SE3_ego[1, 0, 3] - poses.city_SE3_ego[0, 0, 3] == pytest.approx(1.1131949)


@pytest.mark.parametrize(
    ("oxts", "calibration_key", "warning"),
    [
        ("0 0 100 0 0 0", "Tr_imu_velo", "where the IMU stands"),  # the key is taken away
        ("0 0 100", None, "line 1 has 3 fields"),
        ("0 0 100 0 0 north", None, "no number"),
    ],
)
def test_oxts_that_cannot_be_used(kitti_root: Path, oxts: str, calibration_key: str | None, warning: str) -> None:
    folder = kitti_root / "training" / "oxts"
    folder.mkdir()
    (folder / "0007.txt").write_text(oxts)
    if calibration_key:
        calibration = kitti_root / "training" / "calib" / "0007.txt"
        calibration.write_text(calibration.read_text().replace(calibration_key, "Other"))
    drive = open_drive(kitti_root)
    assert drive.poses is None
    assert warning in drive.warnings[0]


def test_truth_is_found_by_frame_number(kitti_root: Path) -> None:
    (kitti_root / "training" / "image_02" / "0007" / "000001.png").unlink()
    folder = kitti_root / "training" / "label_02"
    folder.mkdir()
    row = "5 Van 0 0 0 1 2 3 4 1.5 2 4 0 1.65 10 0\n"
    (folder / "0007.txt").write_text(f"1 {row}3 {row}99 {row}")
    drive = open_drive(kitti_root)
    truth = drive.read_truth(drive.frames)
    assert truth is not None
    assert truth.boxes_2d is not None
    assert truth.boxes_3d is not None
    assert truth.boxes_2d.frame_index.tolist() == truth.boxes_3d.frame_index.tolist() == [2]  # number 3 is frame 2


def test_several_sequences_must_be_named(kitti_root: Path) -> None:
    images = kitti_root / "training" / "image_02" / "0007"
    shutil.copytree(images, images.with_name("0012"))
    shutil.copytree(images, kitti_root / "testing" / "image_02" / "0007")
    with pytest.raises(DriveError, match=r"3 KITTI sequences: training/0007, training/0012, testing/0007\. Name"):
        open_drive(kitti_root)
    with pytest.raises(DriveError, match="2 KITTI sequences: training/0007, testing/0007"):
        open_drive(kitti_root, scene="0007")
    with pytest.raises(DriveError, match=r"no KITTI sequence named 0099.*training/0007, training/0012"):
        open_drive(kitti_root, scene="0099")
    assert open_drive(kitti_root, scene="0012").name == "kitti_0012"
    assert len(open_drive(kitti_root, scene="testing/0007").frames) == 5


def test_folders_without_a_sequence(tmp_path: Path) -> None:
    (tmp_path / "image_02").mkdir()
    with pytest.raises(DriveError, match="hold no sequence"):
        open_drive(tmp_path)
