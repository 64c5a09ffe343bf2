from collections.abc import Sequence

import numpy as np
import pytest

from labeler.detection.types import Detections
from labeler.drive.types import Calibration, Camera
from labeler.geometry.se3 import se3
from labeler.lidar import LidarConfig, View, paint_cloud, paint_points

CONFIG = LidarConfig()
# Looks along x of the ego frame from its origin; 100 px focal length, middle at (200, 100).
EGO_SE3_CAMERA = se3([[0, 0, 1], [-1, 0, 0], [0, -1, 0]], [0, 0, 0])
CAMERA = Camera("front", 400, 200, Calibration(np.array([[100.0, 0, 200], [0, 100, 100], [0, 0, 1]]), EGO_SE3_CAMERA))


def detections(*boxes: tuple[float, float, float, float], score: float = 0.8) -> Detections:
    return Detections(
        np.array(boxes, np.float32).reshape(-1, 4),
        np.full(len(boxes), score, np.float32),
        np.zeros(len(boxes), np.int16),
    )


def points(*xyz: tuple[float, float, float]) -> np.ndarray:
    return np.array(xyz, np.float32).reshape(-1, 3)


def test_a_point_in_the_middle_of_a_box_takes_its_score_and_one_near_the_edge_less():
    # 10 m ahead: 1 m to the left is 10 px to the left of the middle.
    painted = paint_points(points((10, 0, 0), (10, 2, 0)), detections((180, 80, 220, 120)), View.of(CAMERA), CONFIG)
    np.testing.assert_array_equal(painted.row, [0, 1])
    np.testing.assert_allclose(painted.pixel, [[200, 100], [180, 100]], atol=1e-3)
    np.testing.assert_allclose(painted.depth_m, [10, 10], atol=1e-5)
    np.testing.assert_allclose(painted.score, [0.8, 0.8 * np.exp(-1)], rtol=1e-3)


@pytest.mark.parametrize(
    "point",
    [
        (-10, 0, 0),  # behind the camera, though its mirror image falls into the box
        (0, 0, 0),  # in the camera
        (10, 8, 0),  # inside of the image, far from the box
        (10, 0, 11),  # above the image
        (np.nan, 0, 0),  # broken
        (10, 0, np.nan),  # broken in z only
    ],
)
def test_points_that_no_box_sees_get_no_paint(point: tuple[float, float, float]):
    assert len(paint_points(points(point), detections((180, 80, 220, 120)), View.of(CAMERA), CONFIG)) == 0


def test_a_point_in_the_margin_of_a_box_is_listed_without_paint():
    painted = paint_points(points((10, 2.5, 0)), detections((180, 80, 220, 120)), View.of(CAMERA), CONFIG)
    assert painted.score.tolist() == [0.0]  # 175 px: within 0.25 of 40 px from the box


def test_a_point_in_two_boxes_is_painted_by_both_in_order_of_detections():
    painted = paint_points(
        points((10, 0, 0)), detections((180, 80, 220, 120), (190, 90, 210, 110)), View.of(CAMERA), CONFIG
    )
    assert painted.detection_index.tolist() == [0, 1]


def test_weak_and_broken_detections_paint_nothing():
    box = (180.0, 80.0, 220.0, 120.0)
    assert len(paint_points(points((10, 0, 0)), detections(box, score=0.05), View.of(CAMERA), CONFIG)) == 0
    broken = detections((np.nan, 80, 220, 120), box)
    assert paint_points(points((10, 0, 0)), broken, View.of(CAMERA), CONFIG).detection_index.tolist() == [1]


def test_the_motion_of_the_car_between_sweep_and_image_is_taken_out():
    # The car drives 1 m ahead after the sweep, so a point 11 m ahead then is 10 m ahead of the camera now.
    view = View.of(CAMERA, se3(np.eye(3), [-1, 0, 0]))
    painted = paint_points(points((11, 1, 0)), detections((180, 80, 220, 120)), view, CONFIG)
    np.testing.assert_allclose(painted.depth_m, [10], atol=1e-5)
    np.testing.assert_allclose(painted.pixel, [[190, 100]], atol=1e-3)


def test_a_camera_without_calibration_has_no_view():
    with pytest.raises(ValueError, match="front has no calibration"):
        View.of(Camera("front", 400, 200, None))


class Halves:
    """A segmentation whose left half shows vehicles and whose right half shows road."""

    class_names = ("road", "vehicle")

    def sums_at(self, pixels: np.ndarray, groups: Sequence[Sequence[int]]) -> np.ndarray:
        left = (pixels[:, 0] < 200).astype(np.float32)
        return np.stack([np.stack([1 - left, left])[list(group)].sum(axis=0) for group in groups], axis=1)


@pytest.mark.parametrize(
    ("scores", "expected"),
    [
        # In the left half, in the right half, hidden behind the first, behind the camera.
        (Halves(), [[1, 0], [0, 0], [0, 0], [0, 0]]),
        (None, [[0.8 * np.exp(-0.25), 0], [0.8 * np.exp(-0.25), 0], [0, 0], [0, 0]]),
    ],
)
def test_a_cloud_is_painted_where_the_image_shows_its_points(scores: Halves | None, expected: list[list[float]]):
    near = [(10, 1 + shift, 0) for shift in (-0.3, 0.0, 0.3)]  # wide enough to hide what is behind
    cloud = paint_cloud(
        points(*near, (10, -1, 0), (20, 2, 0), (-10, 0, 0)),
        np.arange(6, dtype=np.float32),
        View.of(CAMERA),
        painted_classes=("car", "person"),
        detections=detections((180, 80, 220, 120)),
        class_names=("car",),
        scores=scores,
        config=CONFIG,
    )
    assert cloud.points.shape == (6, 6)
    np.testing.assert_allclose(cloud.points[[1, 3, 4, 5], 4:], expected, atol=1e-5)
    np.testing.assert_array_equal(cloud.points[:, 3], np.arange(6))
    np.testing.assert_array_equal(cloud.seen, [True, True, True, True, False, False])


def test_a_segmentation_takes_the_paint_from_what_it_says_is_no_vehicle():
    found = detections((180, 80, 220, 120))
    painted = paint_points(
        points((10, 1, 0), (10, -1, 0)), found, View.of(CAMERA), CONFIG, class_names=("car",), scores=Halves()
    )
    np.testing.assert_allclose(painted.score, [0.8 * np.exp(-0.25), 0.05 * 0.8 * np.exp(-0.25)], rtol=1e-3)


def test_the_sides_that_cut_a_box_and_what_lies_beyond_them():
    view = View.of(CAMERA)
    sides = view.sides_cutting(np.array([[0, 20, 50, 80], [100, 50, 399.5, 200], [10, 10, 20, 20]]))
    np.testing.assert_array_equal(sides, [[1, 0, 0, 0], [0, 0, 1, 1], [0, 0, 0, 0]])
    beyond = view.beyond(points((10, 21, 0), (10, 19, 0), (-5, 9, 0), (10, -21, 0)), sides[0])  # 63 degrees to the left
    np.testing.assert_array_equal(beyond, [True, False, True, False])
