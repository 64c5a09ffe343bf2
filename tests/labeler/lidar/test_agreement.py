"""Cars at 8 to 30 m seen by a camera that is turned against its calibration, or is not."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from labeler.detection.types import Detections
from labeler.drive.types import Sweep
from labeler.geometry.se3 import se3
from labeler.lidar import (
    Agreement,
    CameraInput,
    LidarConfig,
    View,
    calibration_warnings,
    measure_agreement,
    prepare_scene,
)

CONFIG = LidarConfig()
LOOKS_AHEAD = np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])
INTRINSICS = np.array([[400.0, 0, 600], [0, 400, 200], [0, 0, 1]])
CAR_M, ROAD_Z_M = (1.9, 1.6), -1.7


def backs_of_cars() -> list[np.ndarray]:
    """The sides that cars turn to the camera, 1.9 m wide and 1.6 m tall."""
    cars = []
    for x, y in [(8, 0), (9, 6), (10, -5), (14, 3), (15, -4), (20, 0), (22, 8), (25, -7), (28, 3), (30, -2)]:
        y_m, z_m = np.meshgrid(np.linspace(-0.95, 0.95, 30), np.linspace(ROAD_Z_M, ROAD_Z_M + 1.6, 12))
        cars.append(np.stack([np.full(y_m.size, float(x)), y + y_m.ravel(), z_m.ravel()], axis=1))
    return cars


def measured(axis: str, turned_deg: float) -> Agreement:
    """What two frames say when the images were taken by a camera that was turned about one of its own axes."""
    cars = backs_of_cars()
    x, y = (grid.ravel() for grid in np.meshgrid(np.arange(2, 60, 0.7), np.arange(-20, 20, 0.7)))
    xyz_m = np.concatenate([np.stack([x, y, np.full(len(x), ROAD_Z_M)], axis=1), *cars]).astype(np.float32)
    scene = prepare_scene(Sweep(0, xyz_m, np.zeros(len(xyz_m), np.float32)), CONFIG)
    turn = Rotation.from_euler(axis, turned_deg, degrees=True).as_matrix()
    true_view = View(se3(LOOKS_AHEAD @ turn, [0, 0, 0]), INTRINSICS, (1200, 400))
    pixels = [true_view.see(car.astype(np.float32)).pixel for car in cars]
    boxes_px = np.array([[*pixel.min(axis=0), *pixel.max(axis=0)] for pixel in pixels], np.float32)
    found = Detections(boxes_px, np.full(len(cars), 0.9, np.float32), np.zeros(len(cars), np.int16))
    told = CameraInput(View(se3(LOOKS_AHEAD, [0, 0, 0]), INTRINSICS, (1200, 400)), found)
    once = measure_agreement(scene, told, CONFIG, class_names=("car",))
    return once.plus(once)


def test_a_right_calibration_is_not_complained_about():
    agreement = measured("y", 0)
    assert agreement.near == 20
    assert agreement.found > 10  # some hide one another
    assert abs(np.median(agreement.right_deg)) < 0.2
    assert calibration_warnings({"front": agreement}) == []


@pytest.mark.parametrize(
    ("axis", "turned_deg", "right_deg", "down_deg", "words"),
    [
        ("y", 2.5, 2.5, 0.0, "degrees to the right of where"),  # looks to the right: its image shows objects more left
        ("y", -3.0, -3.0, 0.0, "degrees to the left of where"),
        ("x", 2.5, 0.0, -2.5, "degrees above where"),  # looks up: its image shows objects lower
        ("x", -2.5, 0.0, 2.5, "degrees below where"),
    ],
)
def test_a_turned_camera_is_named_with_its_angle(
    axis: str, turned_deg: float, right_deg: float, down_deg: float, words: str
):
    agreement = measured(axis, turned_deg)
    assert np.median(agreement.right_deg) == pytest.approx(right_deg, abs=0.6)
    assert np.median(agreement.down_deg) == pytest.approx(down_deg, abs=0.6)
    (warning,) = calibration_warnings({"front": agreement})
    assert warning.startswith("Camera front: the LiDAR points of objects lie ")
    assert words in warning


def test_a_camera_whose_detections_have_no_points_is_named():
    (warning,) = calibration_warnings({"left": Agreement(40, 3, (0.1,) * 3, (0.1,) * 3)})
    assert warning.startswith("Camera left: only 3 of 40 near detections")


def test_few_objects_say_nothing():
    assert calibration_warnings({"front": Agreement(5, 5, (4.0,) * 5, (0.0,) * 5)}) == []
