"""Synthetic cars on a flat road 1.7 m under the sensor, seen by a camera at the sensor that looks along x."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labeler.detection.types import Detections
from labeler.drive import open_drive
from labeler.drive.types import Calibration, Camera, Sweep
from labeler.geometry.boxes_3d import corners_of
from labeler.geometry.projection import project_points
from labeler.geometry.se3 import se3
from labeler.lidar import Boxes3D, CameraInput, LidarConfig, View, open_box_maker, prepare_scene

CONFIG = LidarConfig()
CLASS_NAMES = ("person", "car", "bus")
PERSON, CAR, BUS = range(3)
ROAD_Z_M = -1.7
INTRINSICS = np.array([[700.0, 0, 600], [0, 700, 180], [0, 0, 1]])
CAMERA = Camera("front", 1200, 360, Calibration(INTRINSICS, se3([[0, 0, 1], [-1, 0, 0], [0, -1, 0]], [0, 0, 0])))


def road() -> np.ndarray:
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(2, 60, 0.7), np.arange(-20, 20, 0.7)))
    return np.stack([x, y, np.full(len(x), ROAD_Z_M)], axis=1)


def seen_sides(
    center_m: tuple[float, float], size_m: tuple[float, float, float], yaw_deg: float, *, step_m: float = 0.12
) -> np.ndarray:
    """Points on the upright sides of a box that face the origin."""
    length_m, width_m, height_m = size_m
    yaw_rad = np.radians(yaw_deg)
    forward, left = np.array([np.cos(yaw_rad), np.sin(yaw_rad)]), np.array([-np.sin(yaw_rad), np.cos(yaw_rad)])
    points = []
    for normal, along, reach_m, half_m in (
        (forward, left, length_m / 2, width_m / 2), (-forward, left, length_m / 2, width_m / 2),
        (left, forward, width_m / 2, length_m / 2), (-left, forward, width_m / 2, length_m / 2),
    ):  # fmt: skip
        middle = np.array(center_m) + reach_m * normal
        if middle @ normal < 0:
            for u in np.arange(-half_m, half_m + 1e-9, step_m):
                points += [[*(middle + u * along), z] for z in np.arange(ROAD_Z_M + 0.1, ROAD_Z_M + height_m, 0.2)]
    return np.array(points)


def box_px(center_m: tuple[float, float], size_m: tuple[float, float, float], yaw_deg: float) -> list[float]:
    """The box of an object in the image, cut by its edge."""
    center = np.array([[*center_m, ROAD_Z_M + size_m[2] / 2]])
    corners_m = corners_of(center, np.array([size_m]), np.array([np.radians(yaw_deg)]))[0]
    assert CAMERA.calibration is not None
    pixel, _ = project_points(corners_m, CAMERA.calibration.ego_SE3_camera, INTRINSICS)
    pixel = np.clip(pixel, 0, [CAMERA.width_px, CAMERA.height_px])
    return [*pixel.min(axis=0), *pixel.max(axis=0)]


def detections(*boxes: list[float], class_id: int = CAR) -> Detections:
    return Detections(
        np.array(boxes, np.float32).reshape(-1, 4),
        np.full(len(boxes), 0.9, np.float32),
        np.full(len(boxes), class_id, np.int16),
    )


def fit(points: list[np.ndarray], found: Detections, camera: Camera = CAMERA) -> Boxes3D:
    xyz_m = np.concatenate([road(), *points]).astype(np.float32)
    return make(Sweep(0, xyz_m, np.zeros(len(xyz_m), np.float32)), found, camera)


def make(sweep: Sweep, found: Detections, camera: Camera = CAMERA) -> Boxes3D:
    maker = open_box_maker(CONFIG, class_names=CLASS_NAMES)
    return maker.boxes(prepare_scene(sweep, CONFIG), {"front": CameraInput(View.of(camera), found)})["front"]


def off_deg(yaw_rad: float, yaw_deg: float) -> float:
    """How far a yaw is off when front and back count the same."""
    return abs((np.degrees(yaw_rad) - yaw_deg + 90) % 180 - 90)


USUAL_CAR_M = (4.6, 1.9, 1.6)


@pytest.mark.parametrize(
    ("center_m", "yaw_deg"),
    [
        ((15.0, 4.0), 0.0),  # ahead in the next lane: its back and its right side
        ((20.0, -5.0), 30.0),  # turning
        ((12.0, 3.0), 90.0),  # crossing: its whole side
        ((25.0, -6.0), 135.0),  # parked askew
        ((15.0, 0.0), 0.0),  # straight ahead: its back alone, the length is that of its class
    ],
)
def test_a_car_seen_from_its_near_sides_is_boxed_whole(center_m: tuple[float, float], yaw_deg: float):
    boxes = fit([seen_sides(center_m, USUAL_CAR_M, yaw_deg)], detections(box_px(center_m, USUAL_CAR_M, yaw_deg)))
    assert boxes.detection_index.tolist() == [0]
    assert boxes.class_id.tolist() == [CAR]
    np.testing.assert_allclose(boxes.center_m[0], [*center_m, ROAD_Z_M + 0.8], atol=0.2)
    np.testing.assert_allclose(boxes.size_m[0], USUAL_CAR_M, atol=0.35)
    assert off_deg(float(boxes.yaw_rad[0]), yaw_deg) < 5
    assert boxes.num_points[0] > 50
    assert 0.5 < boxes.score[0] <= 1


def test_a_wall_behind_the_car_and_a_post_before_it_are_not_the_car():
    wall = np.array([[24.0, y, z] for y in np.arange(-8, 12, 0.15) for z in np.arange(-1.5, 2, 0.2)])
    post = np.array([[8.0, 1.5, z] for z in np.arange(-1.6, 1.5, 0.1)])
    center_m = (15.0, 3.0)
    car = seen_sides(center_m, USUAL_CAR_M, 0)
    boxes = fit([car, wall, post], detections(box_px(center_m, USUAL_CAR_M, 0)))
    np.testing.assert_allclose(boxes.center_m[0, :2], center_m, atol=0.2)
    assert boxes.num_points[0] <= len(car)


def test_a_near_car_hides_a_far_one_and_both_get_their_own_points():
    near_m, far_m = (12.0, 1.0), (24.0, 3.2)
    near, far = seen_sides(near_m, USUAL_CAR_M, 0), seen_sides(far_m, USUAL_CAR_M, 0)
    boxes_px = [box_px(far_m, USUAL_CAR_M, 0), box_px(near_m, USUAL_CAR_M, 0)]
    boxes = fit([near, far], detections(*boxes_px))
    assert boxes.detection_index.tolist() == [0, 1]
    np.testing.assert_allclose(boxes.center_m[:, :2], [far_m, near_m], atol=0.3)


def test_a_car_cut_by_the_edge_of_the_image_reaches_beyond_it():
    center_m, yaw_deg = (9.0, 6.5), 0.0  # its back half lies outside of the image
    side = seen_sides(center_m, USUAL_CAR_M, yaw_deg)
    boxes = fit([side], detections(box_px(center_m, USUAL_CAR_M, yaw_deg)))
    assert boxes.num_points[0] < len(side)
    np.testing.assert_allclose(boxes.center_m[0, :2], center_m, atol=0.8)


def test_an_object_longer_than_usual_keeps_its_length():
    size_m, center_m = (13.0, 2.6, 3.2), (22.0, 5.0)
    boxes = fit([seen_sides(center_m, size_m, 0)], detections(box_px(center_m, size_m, 0), class_id=BUS))
    assert boxes.size_m[0, 0] == pytest.approx(13.0, abs=0.5)


def test_two_detections_of_one_car_give_one_box():
    center_m = (15.0, 4.0)
    twice = box_px(center_m, USUAL_CAR_M, 0)
    assert len(fit([seen_sides(center_m, USUAL_CAR_M, 0)], detections(twice, twice))) == 1


@pytest.mark.parametrize(
    "count",
    [
        0,  # nothing but road in the box
        CONFIG.min_points - 1,  # too few to say where it is
    ],
)
def test_too_few_points_give_no_box(count: int):
    center_m = (15.0, 4.0)
    points = seen_sides(center_m, USUAL_CAR_M, 0)[5 : 5 + count].reshape(-1, 3)
    assert len(fit([points], detections(box_px(center_m, USUAL_CAR_M, 0)))) == 0


def test_nothing_in_gives_nothing_out():
    empty = Sweep(0, np.zeros((0, 3), np.float32), np.zeros(0, np.float32))
    found = detections([100, 100, 300, 200])
    assert len(make(empty, found)) == 0
    assert len(fit([], Detections.empty())) == 0


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**31),
    count=st.integers(0, 60),
    spread_m=st.sampled_from([0.0, 0.01, 1.0, 30.0]),
    broken=st.booleans(),
)
def test_boxes_are_finite_whatever_the_points(seed: int, count: int, spread_m: float, broken: bool):
    rng = np.random.default_rng(seed)
    points = rng.normal([12, 0, 0], spread_m, (count, 3)).astype(np.float32)
    if broken and count:
        points[rng.integers(0, count, 3), rng.integers(0, 3, 3)] = [np.nan, np.inf, -np.inf]
    sweep = Sweep(0, points, np.zeros(count, np.float32))
    found = Detections(
        rng.uniform(-50, 1250, (5, 4)).astype(np.float32),  # some are inside out
        rng.uniform(0, 1, 5).astype(np.float32),
        rng.integers(0, len(CLASS_NAMES), 5).astype(np.int16),
    )
    boxes = make(sweep, found)
    for array in (
        boxes.center_m,
        boxes.size_m,
        boxes.yaw_rad,
        boxes.score,
        boxes.center_std_m,
        boxes.yaw_std_rad,
        boxes.seen_m,
    ):
        assert np.isfinite(array).all()
    assert (boxes.size_m > 0).all()
    assert (boxes.num_points >= CONFIG.min_points).all()
    assert len(set(boxes.detection_index.tolist())) == len(boxes)


@pytest.mark.real_drive
def test_true_boxes_of_a_real_drive_lead_to_the_true_places(tri_scene_01: Path):
    drive = open_drive(tri_scene_01)
    truth = drive.read_truth(drive.frames)
    assert truth is not None
    assert truth.boxes_2d is not None
    assert truth.boxes_3d is not None
    flat, solid = truth.boxes_2d, truth.boxes_3d
    frame = drive.frames[0]
    assert frame.sweep is not None
    sweep = drive.read_sweep(frame.sweep)
    places = {uuid: solid.center_m[i] for i, uuid in enumerate(solid.track_uuid) if solid.frame_index[i] == frame.index}
    errors_m: list[float] = []
    for camera in drive.cameras:
        rows = [i for i, name in enumerate(flat.camera) if name == camera.name and flat.frame_index[i] == frame.index]
        found = detections(*[flat.xyxy_px[row].tolist() for row in rows])
        boxes = make(sweep, found, camera)
        for center_m, index in zip(boxes.center_m, boxes.detection_index, strict=True):
            place_m = places.get(flat.track_uuid[rows[index]])
            if place_m is not None and np.hypot(*place_m[:2]) < 30:
                errors_m.append(float(np.hypot(*(center_m[:2] - place_m[:2]))))
    assert len(errors_m) >= 8
    assert np.median(errors_m) < 0.5
    assert np.mean(np.array(errors_m) < 1.0) > 0.8
