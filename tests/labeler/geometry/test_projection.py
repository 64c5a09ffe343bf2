"""The pinhole camera: hand-computed pixels and properties."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labeler.geometry.projection import project_points
from labeler.geometry.se3 import invert_se3, se3, transform_points

_INTRINSICS = np.array([[100.0, 0, 320], [0, 200, 240], [0, 0, 1]])
# A camera that looks ahead: its x is the ego's -y, its y the ego's -z, its z the ego's x. It stands 1 m ahead, 2 m up.
_EGO_SE3_FRONT = se3([[0, 0, 1], [-1, 0, 0], [0, -1, 0]], [1.0, 0.0, 2.0])


@pytest.mark.parametrize(
    ("point_ego_m", "pixel", "depth_m"),
    [
        ([11, 0, 2], (320, 240), 10),  # on the optical axis: the principal point
        ([11, 1, 2], (310, 240), 10),  # 1 m to the left: 100 / 10 px to the left
        ([11, -2, 2], (340, 240), 10),  # to the right
        ([11, 0, 3], (320, 220), 10),  # 1 m above: 200 / 10 px up
        ([3, 0, 0], (320, 440), 2),  # the road just ahead
        ([2, 50, 2], (-4680, 240), 1),  # far outside of the image, but before the camera
    ],
)
def test_pixels(point_ego_m: list[float], pixel: tuple[float, float], depth_m: float) -> None:
    pixels, depths_m = project_points(np.array([point_ego_m], dtype=float), _EGO_SE3_FRONT, _INTRINSICS)
    assert pixels[0].tolist() == pytest.approx(pixel)
    assert depths_m.tolist() == pytest.approx([depth_m])


@pytest.mark.parametrize("point_ego_m", [[0.5, 0, 2], [-10, 3, 1], [1, 4, 4]])  # behind, far behind, in its plane
def test_points_that_are_not_before_the_camera_have_no_pixel(point_ego_m: list[float]) -> None:
    pixels, depths_m = project_points(np.array([point_ego_m]), _EGO_SE3_FRONT, _INTRINSICS)
    assert np.isnan(pixels).all()
    assert depths_m[0] == pytest.approx(point_ego_m[0] - 1)


def test_no_points_have_no_pixels() -> None:
    pixels, depths_m = project_points(np.zeros((0, 3), dtype=np.float32), _EGO_SE3_FRONT, _INTRINSICS)
    assert pixels.shape == (0, 2)
    assert depths_m.shape == (0,)


@given(st.floats(0.5, 200), st.floats(0, 640), st.floats(0, 480))
def test_a_pixel_and_its_depth_give_the_point_back(depth_m: float, u: float, v: float) -> None:
    point_camera_m = depth_m * np.linalg.solve(_INTRINSICS, [u, v, 1])
    point_ego_m = transform_points(_EGO_SE3_FRONT, point_camera_m[None])
    pixels, depths_m = project_points(point_ego_m, _EGO_SE3_FRONT, _INTRINSICS)
    np.testing.assert_allclose(pixels[0], [u, v], atol=1e-6)
    assert depths_m[0] == pytest.approx(depth_m)


@given(st.floats(1, 100), st.floats(-50, 50), st.floats(-5, 5), st.floats(1.1, 20))
def test_points_on_one_ray_share_a_pixel(x_m: float, y_m: float, z_m: float, factor: float) -> None:
    points_camera_m = np.array([[y_m, z_m, x_m], [y_m * factor, z_m * factor, x_m * factor]])
    points_ego_m = transform_points(_EGO_SE3_FRONT, points_camera_m)
    pixels, _ = project_points(points_ego_m, _EGO_SE3_FRONT, _INTRINSICS)
    np.testing.assert_allclose(pixels[0], pixels[1], rtol=1e-9, atol=1e-6)


def test_moving_camera_and_points_together_changes_nothing() -> None:
    moved_SE3_ego = se3([[0, -1, 0], [1, 0, 0], [0, 0, 1]], [5.0, -3.0, 1.0])
    points_ego_m = np.array([[12.0, 2.0, 1.0], [30.0, -7.0, 0.0]])
    before, _ = project_points(points_ego_m, _EGO_SE3_FRONT, _INTRINSICS)
    after, _ = project_points(
        transform_points(moved_SE3_ego, points_ego_m), moved_SE3_ego @ _EGO_SE3_FRONT, _INTRINSICS
    )
    np.testing.assert_allclose(after, before)
    np.testing.assert_allclose(invert_se3(moved_SE3_ego) @ moved_SE3_ego, np.eye(4), atol=1e-12)
