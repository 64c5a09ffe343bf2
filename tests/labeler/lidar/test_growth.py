"""A car abreast of the ego car, half in the front camera's image and half in the left one's."""

import numpy as np
import pytest

from labeler.detection.types import Detections
from labeler.drive.types import Sweep
from labeler.geometry.boxes_3d import corners_of
from labeler.geometry.se3 import se3
from labeler.lidar import Boxes3D, CameraInput, LidarConfig, View, open_box_maker, prepare_scene

CONFIG = LidarConfig()
INTRINSICS = np.array([[400.0, 0, 400], [0, 400, 200], [0, 0, 1]])  # sees 45 degrees to either side
SIZE_PX = (800, 400)
LOOKS = {"front": [[0, 0, 1], [-1, 0, 0], [0, -1, 0]], "left": [[1, 0, 0], [0, 0, 1], [0, -1, 0]]}
VIEWS = {name: View(se3(turn, [0, 0, 0]), INTRINSICS, SIZE_PX) for name, turn in LOOKS.items()}
CAR_M, ROAD_Z_M = (4.6, 1.9, 1.6), -1.7
CENTER_M = np.array([6.0, 6.0, ROAD_Z_M + 0.8])


def side_of_car(center_m: np.ndarray) -> np.ndarray:
    """Points on the side and the back of a car ahead on the left, that both face the origin."""
    heights = np.arange(ROAD_Z_M + 0.4, ROAD_Z_M + 1.6, 0.2)
    side = [[center_m[0] + u, center_m[1] - 0.95, z] for u in np.arange(-2.3, 2.31, 0.1) for z in heights]
    back = [[center_m[0] - 2.3, center_m[1] + v, z] for v in np.arange(-0.95, 0.96, 0.1) for z in heights]
    return np.array(side + back)


def road() -> np.ndarray:
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(-30, 30, 0.7), np.arange(-30, 30, 0.7)))
    return np.stack([x, y, np.full(len(x), ROAD_Z_M)], axis=1)


def box_px(camera: str, center_m: np.ndarray = CENTER_M) -> list[float]:
    """The box of the part of a car that an image shows: of points all over its surface that project into it."""
    low, high = (corners_of(center_m[None], np.array([CAR_M]), np.zeros(1))[0].T.min(1), center_m + np.array(CAR_M) / 2)
    grid = np.stack(np.meshgrid(*(np.linspace(a, b, 40) for a, b in zip(low, high, strict=True))), axis=-1)
    seen = VIEWS[camera].see(grid.reshape(-1, 3).astype(np.float32))
    return [*seen.pixel.min(axis=0), *seen.pixel.max(axis=0)]


def boxes(found: dict[str, list[list[float]]], *points: np.ndarray) -> dict[str, Boxes3D]:
    xyz_m = np.concatenate([road(), *points]).astype(np.float32)
    scene = prepare_scene(Sweep(0, xyz_m, np.zeros(len(xyz_m), np.float32)), CONFIG)
    cameras = {
        name: CameraInput(
            VIEWS[name],
            Detections(np.array(px, np.float32), np.full(len(px), 0.9, np.float32), np.zeros(len(px), np.int16)),
        )
        for name, px in found.items()
    }
    return open_box_maker(CONFIG, class_names=("car",)).boxes(scene, cameras)


def test_two_cameras_that_see_parts_of_a_car_come_to_the_same_box():
    made = boxes({name: [box_px(name)] for name in VIEWS}, side_of_car(CENTER_M))
    for name in VIEWS:
        np.testing.assert_allclose(made[name].center_m, CENTER_M[None], atol=0.2)
        np.testing.assert_allclose(made[name].size_m[0, :2], CAR_M[:2], atol=0.3)
    np.testing.assert_array_equal(made["front"].center_m, made["left"].center_m)


@pytest.mark.parametrize("camera", ["front", "left"])
def test_one_camera_alone_takes_in_what_lies_beyond_its_border(camera: str):
    made = boxes({camera: [box_px(camera)]}, side_of_car(CENTER_M))[camera]
    np.testing.assert_allclose(made.center_m, CENTER_M[None], atol=0.3)
    assert made.num_points[0] > 0.9 * len(side_of_car(CENTER_M))


def test_a_car_that_another_camera_sees_whole_is_not_grown_over():
    # The second car parks 1.4 m before the first, whole in the front image.
    ahead_m = CENTER_M + np.array([6.0, 0, 0])
    found = {"front": [box_px("front", ahead_m), box_px("front")], "left": [box_px("left")]}
    made = boxes(found, side_of_car(CENTER_M), side_of_car(ahead_m))
    np.testing.assert_allclose(made["front"].center_m[:, :2], [ahead_m[:2], CENTER_M[:2]], atol=0.4)
    np.testing.assert_allclose(made["left"].center_m[0, :2], CENTER_M[:2], atol=0.4)
