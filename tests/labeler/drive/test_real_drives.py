"""The readers on recorded drives: what is there, and that LiDAR and cameras agree."""

from pathlib import Path

import numpy as np
import pytest

from labeler.drive import Drive, open_drive, read_image
from labeler.geometry.boxes_3d import corners_of
from labeler.geometry.projection import project_points

pytestmark = pytest.mark.real_drive


def _share_in_image(drive: Drive, camera_name: str) -> float:
    """Of the LiDAR points in the view's cone, the share that lies in the lower two thirds of the image."""
    camera = drive.camera(camera_name)
    assert camera.calibration is not None
    assert drive.frames[0].sweep is not None
    points = drive.read_sweep(drive.frames[0].sweep).xyz_m
    pixels, depths_m = project_points(points, camera.calibration.ego_SE3_camera, camera.calibration.intrinsics)
    inside = (depths_m > 1) & (np.abs(pixels / [camera.width_px, camera.height_px] - 0.5) < 0.5).all(axis=1)
    assert np.count_nonzero(inside) > 500
    return float(np.mean(pixels[inside, 1] > camera.height_px / 3))


def _read_all_of_first_frame(drive: Drive) -> None:
    for name, image in drive.frames[0].images.items():
        camera = drive.camera(name)
        assert read_image(image, camera).shape == (camera.height_px, camera.width_px, 3)


def test_tri_scene_01(tri_scene_01: Path) -> None:
    drive = open_drive(tri_scene_01)
    assert drive.format == "argoverse2"
    assert [camera.name for camera in drive.cameras] == ["ring_front_center", "ring_front_left", "ring_front_right"]
    assert [(len(frame.images), frame.sweep is not None) for frame in drive.frames] == [(3, True)] * 3
    assert drive.poses is not None
    assert drive.warnings == ()
    _read_all_of_first_frame(drive)
    assert all(_share_in_image(drive, camera.name) > 0.9 for camera in drive.cameras)


def test_tri_truth_in_3d_projects_onto_truth_in_2d(tri_scene_01: Path) -> None:
    drive = open_drive(tri_scene_01)
    truth = drive.read_truth(drive.frames)
    assert truth is not None
    in_2d, in_3d = truth.boxes_2d, truth.boxes_3d
    assert in_2d is not None
    assert in_3d is not None
    assert (len(in_2d.frame_index), len(in_3d.frame_index)) == (159, 286)
    row_of = {key: row for row, key in enumerate(zip(in_3d.frame_index.tolist(), in_3d.track_uuid, strict=True))}
    corners = corners_of(in_3d.center_m, in_3d.size_m, in_3d.yaw_rad)
    offsets: list[float] = []
    for row, key in enumerate(zip(in_2d.frame_index.tolist(), in_2d.track_uuid, strict=True)):
        calibration = drive.camera(in_2d.camera[row]).calibration
        assert calibration is not None
        if key in row_of:
            pixels, depths_m = project_points(corners[row_of[key]], calibration.ego_SE3_camera, calibration.intrinsics)
            x1, x2 = in_2d.xyxy_px[row, [0, 2]].tolist()
            if (depths_m > 0.5).all() and x1 > 5 and x2 < 1930:
                offsets.append(abs(pixels[:, 0].mean() - (x1 + x2) / 2) / (x2 - x1))
    assert len(offsets) > 50
    assert np.median(offsets) < 0.1


def test_kitti_0052(kitti_0052: Path) -> None:
    drive = open_drive(kitti_0052)
    assert (drive.format, drive.name, len(drive.frames)) == ("kitti", "kitti_0052_0000", 40)
    assert [(camera.name, camera.width_px, camera.height_px) for camera in drive.cameras] == [("image_02", 1242, 375)]
    assert all(frame.sweep is not None and len(frame.images) == 1 for frame in drive.frames)
    assert drive.poses is None
    assert drive.warnings == ()
    _read_all_of_first_frame(drive)
    assert _share_in_image(drive, "image_02") > 0.9


def test_nuscenes_one_sample(nuscenes_one_sample: Path) -> None:
    drive = open_drive(nuscenes_one_sample)
    assert (drive.format, drive.name, len(drive.frames)) == ("nuscenes", "scene-0061", 1)
    assert len(drive.frames[0].images) == len(drive.cameras) == 6
    assert drive.poses is not None
    assert drive.warnings == ()
    _read_all_of_first_frame(drive)
    assert all(_share_in_image(drive, camera.name) > 0.8 for camera in drive.cameras)
