"""The sample drive opens as any drive does, with nothing of the extra `simulation` installed."""

import numpy as np

from labeler.drive import open_drive
from labeler.drive.images import read_image
from labeler.geometry.se3 import yaw_of
from labeler.simulation.sample import sample_drive


def test_it_is_small() -> None:
    files = [path for path in sample_drive().rglob("*") if path.is_file()]
    assert sum(path.stat().st_size for path in files) < 20_000_000
    assert not [path for path in files if path.name.startswith(".")]


def test_it_opens_without_a_warning_and_is_whole() -> None:
    drive = open_drive(sample_drive())
    assert (drive.format, drive.warnings) == ("argoverse2", ())
    assert len(drive.frames) >= 60
    assert {camera.name for camera in drive.cameras} == {"front", "left", "right", "rear"}
    assert all(camera.calibration is not None for camera in drive.cameras)
    for frame in drive.frames:
        assert len(frame.images) == 4
        assert frame.sweep is not None
    last = drive.frames[-1]
    assert last.sweep is not None
    assert len(drive.read_sweep(last.sweep).xyz_m) > 5000
    for camera in drive.cameras:
        assert read_image(last.images[camera.name], camera).std() > 10


def test_the_ego_car_turns_at_a_crossing() -> None:
    drive = open_drive(sample_drive())
    assert drive.poses is not None
    yaw_rad = np.unwrap([yaw_of(pose) for pose in drive.poses.city_SE3_ego])
    assert np.ptp(yaw_rad) > np.radians(70)


def test_its_truth_has_vehicles_that_several_cameras_see() -> None:
    drive = open_drive(sample_drive())
    truth = drive.read_truth(drive.frames)
    assert truth is not None
    assert truth.boxes_2d is not None
    assert truth.boxes_3d is not None
    boxes = truth.boxes_2d
    assert boxes.visible_share is not None
    clearly = boxes.visible_share > 0.5
    cameras: dict[str, set[str]] = {}
    for row in np.flatnonzero(clearly):
        cameras.setdefault(boxes.track_uuid[row], set()).add(boxes.camera[row])
    assert sum(len(seen_by) >= 2 for seen_by in cameras.values()) >= 5
    assert set(boxes.track_uuid) >= set(cameras)
