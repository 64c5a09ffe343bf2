"""A camera at the origin that looks along x: 700 px focal length, the horizon at row 180."""

import numpy as np
import pytest

from labeler.detection.types import Detections
from labeler.drive.types import Sweep
from labeler.geometry.se3 import se3
from labeler.lidar import (
    Boxes3D,
    BoxSource,
    CameraInput,
    LidarConfig,
    PositionSource,
    View,
    find_positions,
    prepare_scene,
)
from labeler.lidar.scene import Scene

CONFIG = LidarConfig()
VIEW = View(
    se3([[0, 0, 1], [-1, 0, 0], [0, -1, 0]], [0, 0, 0]),
    np.array([[700.0, 0, 600], [0, 700, 180], [0, 0, 1]]),
    (1200, 360),
)
CAR_M = (4.6, 1.9, 1.6)
BEHIND_M = (CAR_M[0] + CAR_M[1]) / 4  # the middle of a car behind its near side


def camera(*xyxy_px: tuple[float, float, float, float]) -> CameraInput:
    count = len(xyxy_px)
    boxes_px = np.array(xyxy_px, np.float32).reshape(-1, 4)
    return CameraInput(VIEW, Detections(boxes_px, np.full(count, 0.9, np.float32), np.zeros(count, np.int16)))


def scene(*xyz_m: tuple[float, float, float]) -> Scene:
    """A flat road 1.7 m below, and points."""
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(2, 60, 1.0), np.arange(-20, 20, 1.0)))
    points = np.concatenate([np.stack([x, y, np.full(len(x), -1.7)], axis=1), np.array(xyz_m).reshape(-1, 3)])
    return prepare_scene(Sweep(0, points.astype(np.float32), np.zeros(len(points), np.float32)), CONFIG)


def positions(seen: CameraInput, swept: Scene | None, boxes: Boxes3D | None = None):
    return find_positions(boxes or Boxes3D.empty(), seen, swept, CONFIG, class_names=("car",))


def test_without_lidar_the_height_in_the_image_tells_the_distance():
    # 1.6 m in 56 px at 700 px: the near side is 20 m away; 100 px left of the middle is a seventh to the left.
    found = positions(camera((470, 160, 530, 216)), None)
    assert found.position_source.tolist() == [PositionSource.HEIGHT]
    ray = np.array([20.0, 20 / 7])
    np.testing.assert_allclose(found.position_m[0, :2], ray * (1 + BEHIND_M / np.linalg.norm(ray)), atol=0.01)
    covariance = found.covariances()[0]
    along = ray / np.linalg.norm(ray)
    assert np.sqrt(along @ covariance @ along) > 2  # heights of cars differ by a tenth
    assert np.sqrt(covariance[0, 0] * along[1] ** 2 + covariance[1, 1] * along[0] ** 2) < 2


def test_a_few_points_say_more_than_the_height():
    found = positions(camera((570, 160, 630, 216)), scene((23.0, 0.1, -0.3), (23.1, -0.1, -0.4)))
    assert found.position_source.tolist() == [PositionSource.POINTS]
    assert found.position_m[0, 0] == pytest.approx(23.05 + BEHIND_M, abs=0.1)
    alone = positions(camera((570, 160, 630, 216)), None)
    assert found.position_cov_m2[0, 0] < alone.position_cov_m2[0, 0]


@pytest.mark.parametrize(
    "points",
    [
        [],  # none
        [(50.0, 0.0, -0.3)],  # far behind what looks like 20 m
        [(20.0, 8.0, -0.3)],  # beside the box
        [(20.0, 0.0, -1.65)],  # the road
    ],
)
def test_points_that_are_not_the_objects_tell_nothing(points: list[tuple[float, float, float]]):
    found = positions(camera((570, 160, 630, 216)), scene(*points))
    assert found.position_source.tolist() == [PositionSource.HEIGHT]


def test_an_object_cut_by_the_upper_or_lower_border_is_nearer_and_less_sure_than_it_looks():
    whole, cut = positions(camera((570, 240, 630, 350)), None), positions(camera((570, 250, 630, 360)), None)
    assert cut.position_m[0, 0] < whole.position_m[0, 0]
    assert cut.position_cov_m2[0, 0] > whole.position_cov_m2[0, 0]


def test_the_centre_of_a_box_is_the_position_and_its_deviations_turn_with_it():
    turned = Boxes3D(
        center_m=np.array([[20, 3, -0.9]], np.float32),
        size_m=np.array([CAR_M], np.float32),
        yaw_rad=np.array([np.pi / 2], np.float32),
        score=np.array([0.8], np.float32),
        class_id=np.zeros(1, np.int16),
        num_points=np.array([30], np.int32),
        detection_index=np.array([1], np.int32),
        source=np.array([BoxSource.CLUSTER], np.int8),
        center_std_m=np.array([[0.5, 0.1]], np.float32),
        yaw_std_rad=np.array([0.1], np.float32),
        seen_m=np.zeros((1, 4), np.float32),
        offset_s=np.array([-0.02], np.float32),
    )
    found = positions(camera((570, 160, 630, 216), (470, 160, 530, 216)), None, turned)
    assert found.detection_index.tolist() == [0, 1]
    assert found.position_source.tolist() == [PositionSource.HEIGHT, PositionSource.BOX]
    np.testing.assert_array_equal(found.position_m[1], turned.center_m[0])
    np.testing.assert_allclose(found.covariances()[1], [[0.01, 0], [0, 0.25]], atol=1e-6)
    assert found.position_offset_s[1] == pytest.approx(-0.02)


def test_what_is_no_box_has_no_position():
    seen = camera((600, 160, 500, 216), (np.nan, 0, 10, 10), (570, 160, 630, 216))
    assert positions(seen, None).detection_index.tolist() == [2]
    assert len(positions(camera(), None)) == 0
