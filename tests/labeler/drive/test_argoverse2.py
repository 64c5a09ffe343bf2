"""Argoverse 2 logs: what is read, and each way to be broken."""

from __future__ import annotations

import pickle
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from labeler.drive import DriveError, DriveFileError, open_drive, read_image
from labeler.geometry.projection import project_points

START_NS = 1_000_000_000_000
PERIOD_NS = 100_000_000
WriteImage = Callable[..., Path]
WriteTable = Callable[..., Path]
PosesAlongX = Callable[[Sequence[int]], dict[str, Any]]


def _front(root: Path) -> Path:
    return root / "sensors" / "cameras" / "ring_front_center"


def _warning(root: Path) -> str:
    (warning,) = open_drive(root).warnings
    return warning


def test_a_whole_log(argoverse2_log: Path) -> None:
    drive = open_drive(argoverse2_log)
    assert (drive.name, drive.format, drive.root) == ("a log", "argoverse2", argoverse2_log)
    assert [(c.name, c.width_px, c.height_px) for c in drive.cameras] == [
        ("ring_front_center", 32, 16),
        ("ring_rear", 32, 16),
    ]
    assert [frame.timestamp_ns for frame in drive.frames] == [START_NS + index * PERIOD_NS for index in range(3)]
    assert all(set(frame.images) == {"ring_front_center", "ring_rear"} for frame in drive.frames)
    assert drive.frames[1].images["ring_rear"].timestamp_ns == START_NS + PERIOD_NS + 10_000_000
    assert drive.has_lidar
    assert drive.poses is not None
    assert drive.poses.at(START_NS + PERIOD_NS // 2)[0, 3] == pytest.approx(0.5)
    assert drive.read_truth(drive.frames) is None
    assert drive.warnings == ()


def test_the_front_camera_looks_ahead(argoverse2_log: Path) -> None:
    camera = open_drive(argoverse2_log).camera("ring_front_center")
    assert camera.calibration is not None
    # It stands at (1, 0, 1.5): 10 m ahead of it, 1 m to the left, on its height.
    pixels, depths_m = project_points(
        np.array([[11.0, 1.0, 1.5]]), camera.calibration.ego_SE3_camera, camera.calibration.intrinsics
    )
    assert pixels[0].tolist() == pytest.approx([14, 8])
    assert depths_m.tolist() == pytest.approx([10])


def test_sweeps_and_images_are_read(argoverse2_log: Path) -> None:
    drive = open_drive(argoverse2_log)
    assert drive.frames[0].sweep is not None
    sweep = drive.read_sweep(drive.frames[0].sweep)
    assert sweep.xyz_m.tolist() == [[1, 1, 1], [2, 2, 2], [3, 3, 3]]
    assert sweep.intensity.tolist() == [7, 8, 9]
    assert sweep.xyz_m.dtype == sweep.intensity.dtype == np.float32
    image = drive.frames[0].images["ring_rear"]
    assert read_image(image, drive.camera("ring_rear")).shape == (16, 32, 3)


def test_a_drive_can_be_sent_to_worker_processes(argoverse2_log: Path) -> None:
    drive = pickle.loads(pickle.dumps(open_drive(argoverse2_log)))
    assert len(drive.read_sweep(drive.frames[0].sweep).xyz_m) == 3


def test_truth(argoverse2_log: Path, write_table: WriteTable) -> None:
    half = np.sqrt(0.5)
    times_ns = [START_NS, START_NS + 5]  # the second is of no frame
    write_table(
        argoverse2_log / "annotations.feather",
        {"timestamp_ns": times_ns, "track_uuid": ["car", "x"], "category": ["BUS", "x"], "length_m": [9.0, 1],
         "width_m": [3.0, 1], "height_m": [2.5, 1], "qw": [half, 1], "qx": [0.0, 0], "qy": [0.0, 0], "qz": [half, 0],
         "tx_m": [10.0, 0], "ty_m": [-2.0, 0], "tz_m": [1.0, 0]},
    )  # fmt: skip
    image_ns = START_NS + PERIOD_NS + 10_000_000
    boxes: dict[str, Any] = {"x1_px": [1, 0], "y1_px": [2, 0], "x2_px": [3, 0], "y2_px": [4, 0]}
    visible = {f"visible_{key}": [value[0] + 0.5, 0] for key, value in boxes.items()}
    write_table(
        argoverse2_log / "annotations_2d.feather",
        {"timestamp_ns": [image_ns, image_ns], "camera": ["ring_rear", "gone"], "track_uuid": ["car", "x"],
         "category": ["BUS", "x"], **boxes, **visible, "distance_m": [12.5, 0],
         "visible_share": [0.25, 1], "visible_pixels": [40, 9]},
    )  # fmt: skip
    drive = open_drive(argoverse2_log)
    truth = drive.read_truth(drive.frames)
    assert truth is not None
    assert truth.boxes_3d is not None
    assert truth.boxes_2d is not None
    assert truth.boxes_3d.frame_index.tolist() == [0]
    assert (truth.boxes_3d.track_uuid, truth.boxes_3d.category) == (("car",), ("BUS",))
    assert truth.boxes_3d.center_m.tolist() == [[10, -2, 1]]
    assert truth.boxes_3d.size_m.tolist() == [[9, 3, 2.5]]
    assert truth.boxes_3d.yaw_rad.tolist() == pytest.approx([np.pi / 2])
    assert truth.boxes_2d.frame_index.tolist() == [1]
    assert truth.boxes_2d.camera == ("ring_rear",)
    assert truth.boxes_2d.xyxy_px.tolist() == [[1, 2, 3, 4]]
    assert truth.boxes_2d.visible_xyxy_px is not None
    assert truth.boxes_2d.visible_xyxy_px.tolist() == [[1.5, 2.5, 3.5, 4.5]]
    assert truth.boxes_2d.visible_share is not None
    assert truth.boxes_2d.visible_share.tolist() == [0.25]
    assert truth.boxes_2d.visible_pixels is not None
    assert truth.boxes_2d.visible_pixels.tolist() == [40]
    assert truth.boxes_2d.distance_m is not None
    assert truth.boxes_2d.distance_m.tolist() == [12.5]


def test_broken_truth_names_the_file(argoverse2_log: Path) -> None:
    (argoverse2_log / "annotations.feather").write_text("no feather")
    drive = open_drive(argoverse2_log)
    with pytest.raises(DriveFileError, match=r"annotations\.feather can't be read"):
        drive.read_truth(drive.frames)


@pytest.mark.parametrize("file", ["intrinsics.feather", "egovehicle_SE3_sensor.feather"])
def test_without_calibration_the_cameras_are_labelled_in_2d(argoverse2_log: Path, file: str) -> None:
    (argoverse2_log / "calibration" / file).unlink()
    drive = open_drive(argoverse2_log)
    assert [(c.width_px, c.height_px, c.calibration) for c in drive.cameras] == [(32, 16, None)] * 2
    assert file in drive.warnings[0]
    assert drive.warnings[1] == (
        "No usable calibration for ring_front_center, ring_rear: labelled in 2D only, and no merges between cameras."
    )


def test_a_calibration_of_another_image_size_is_not_used(argoverse2_log: Path, write_image: WriteImage) -> None:
    for file in _front(argoverse2_log).iterdir():
        write_image(file, 16, 8)
    camera = open_drive(argoverse2_log).camera("ring_front_center")
    assert (camera.width_px, camera.height_px, camera.calibration) == (16, 8, None)
    assert "its images are 16 x 8 pixels, but the calibration is for 32 x 16" in _warning(argoverse2_log)


def test_one_image_of_another_size_leaves_the_calibration(argoverse2_log: Path, write_image: WriteImage) -> None:
    write_image(min(_front(argoverse2_log).iterdir()), 16, 8)
    drive = open_drive(argoverse2_log)
    assert drive.camera("ring_front_center").calibration is not None
    assert drive.warnings == ()
    with pytest.raises(DriveFileError, match="16 x 8"):
        read_image(drive.frames[0].images["ring_front_center"], drive.camera("ring_front_center"))


@pytest.mark.parametrize("remove", ["folder", "files"])
def test_a_camera_without_images_is_left_out(argoverse2_log: Path, remove: str) -> None:
    shutil.rmtree(_front(argoverse2_log))
    if remove == "files":
        _front(argoverse2_log).mkdir()
    assert [camera.name for camera in open_drive(argoverse2_log).cameras] == ["ring_rear"]
    assert _warning(argoverse2_log) == "Left out cameras without images: ring_front_center."


@pytest.mark.parametrize(
    ("name", "content", "warning"),
    [
        ("front.jpg", b"x", "not named by a whole number: front.jpg"),
        (f"{START_NS + 50_000_000}.jpg", b"", "empty (0 bytes): 1000050000000.jpg"),
        (f"{START_NS + 10_000_000}.png", b"x", "of a number that another file already has: 1000010000000.png"),
    ],
)
def test_files_that_cannot_be_used_are_skipped(argoverse2_log: Path, name: str, content: bytes, warning: str) -> None:
    (_front(argoverse2_log) / name).write_bytes(content)
    drive = open_drive(argoverse2_log)
    assert [len(frame.images) for frame in drive.frames] == [2, 2, 2]
    assert {frame.images["ring_front_center"].path.suffix for frame in drive.frames} == {".jpg"}
    assert warning in _warning(argoverse2_log)


def test_a_log_without_any_image_says_why(argoverse2_log: Path) -> None:
    for folder in (argoverse2_log / "sensors" / "cameras").iterdir():
        for file in folder.iterdir():
            file.write_bytes(b"")
    with pytest.raises(DriveError, match=r"no camera has an image \(cameras: ring_front_center, ring_rear\).*empty"):
        open_drive(argoverse2_log)


def test_images_without_a_readable_header_are_no_camera(argoverse2_log: Path) -> None:
    shutil.rmtree(argoverse2_log / "calibration")
    for file in _front(argoverse2_log).iterdir():
        file.write_bytes(b"noise")
    drive = open_drive(argoverse2_log)
    assert [camera.name for camera in drive.cameras] == ["ring_rear"]
    assert "none of its 3 images has a readable header" in " ".join(drive.warnings)


def test_without_lidar_the_front_camera_is_the_clock(argoverse2_log: Path) -> None:
    shutil.rmtree(argoverse2_log / "sensors" / "lidar")
    drive = open_drive(argoverse2_log)
    assert not drive.has_lidar
    assert drive.frames[0].timestamp_ns == START_NS + 10_000_000
    assert [len(frame.images) for frame in drive.frames] == [2, 2, 2]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda columns: {key: value for key, value in columns.items() if key != "intensity"}, "lacks the columns int"),
        (lambda columns: {**columns, "x": [float("nan")] * 2 + [1.0]}, "2 of 3 points that are not finite"),
        (lambda columns: {**columns, "x": ["a", "b", "c"]}, "column x must hold numbers"),
    ],
)
def test_broken_sweeps_are_refused(
    argoverse2_log: Path, write_table: WriteTable, change: Callable[[dict[str, Any]], dict[str, Any]], message: str
) -> None:
    drive = open_drive(argoverse2_log)
    assert drive.frames[0].sweep is not None
    columns = {name: [1.0, 2.0, 3.0] for name in ("x", "y", "z", "intensity")}
    write_table(drive.frames[0].sweep.path, change(columns))
    with pytest.raises(DriveFileError, match=message):
        drive.read_sweep(drive.frames[0].sweep)


@pytest.mark.parametrize(
    ("order", "warning"),
    [
        ([2, 0, 1], "out of order and have been sorted"),
        ([0, 0, 1, 2], "left out 1 pose of a time that an earlier row already has"),
    ],
)
def test_pose_tables_are_put_in_order(
    argoverse2_log: Path, write_table: WriteTable, poses_along_x: PosesAlongX, order: list[int], warning: str
) -> None:
    columns = poses_along_x([START_NS + row * PERIOD_NS for row in order])
    write_table(argoverse2_log / "city_SE3_egovehicle.feather", columns)
    poses = open_drive(argoverse2_log).poses
    assert poses is not None
    assert poses.timestamp_ns.tolist() == [START_NS + row * PERIOD_NS for row in range(3)]
    assert warning in _warning(argoverse2_log)


@pytest.mark.parametrize("content", [None, "no feather"])
def test_without_poses_the_drive_still_opens(argoverse2_log: Path, content: str | None) -> None:
    file = argoverse2_log / "city_SE3_egovehicle.feather"
    file.unlink()
    if content:
        file.write_text(content)
    assert open_drive(argoverse2_log).poses is None
    assert "without ego poses" in _warning(argoverse2_log)


def test_a_log_has_no_scenes(argoverse2_log: Path) -> None:
    assert open_drive(argoverse2_log, scene="a log").name == "a log"
    with pytest.raises(DriveError, match="no scene named 0001"):
        open_drive(argoverse2_log, scene="0001")
