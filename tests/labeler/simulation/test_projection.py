"""Matrices of cameras and of the sun against values worked out by hand."""

import numpy as np
import pytest

from labeler.geometry.se3 import invert_se3, se3
from labeler.simulation.projection import (
    FAR_M,
    NEAR_M,
    camera_projection,
    depth_of,
    frustum_planes,
    in_frustum,
    in_sun_map,
    sun_projection,
)

INTRINSICS = np.array([[100.0, 0, 80], [0, 120.0, 30], [0, 0, 1]])


@pytest.mark.parametrize(
    ("point", "pixel"),
    [
        ((0.0, 0.0, 5.0), (80.0, 30.0)),  # on the axis: the principal point, which is not the image's middle
        ((1.0, 0.0, 5.0), (100.0, 30.0)),  # 100 * 1 / 5 to the right
        ((0.0, 1.0, 4.0), (80.0, 60.0)),  # 120 * 1 / 4 down
        ((-4.0, -1.25, 5.0), (0.0, 0.0)),  # the upper left corner
    ],
)
def test_points_land_on_the_pixels_of_the_pinhole(
    point: tuple[float, float, float], pixel: tuple[float, float]
) -> None:
    clip = camera_projection(INTRINSICS, 200, 100) @ np.array([*point, 1.0])
    ndc = clip[:3] / clip[3]

    np.testing.assert_allclose([(ndc[0] + 1) / 2 * 200, (1 - ndc[1]) / 2 * 100], pixel, atol=1e-9)


@pytest.mark.parametrize("depth_m", [NEAR_M, 1.0, 25.0, 300.0, FAR_M * 0.999])
def test_depth_comes_back_from_the_depth_buffer(depth_m: float) -> None:
    clip = camera_projection(INTRINSICS, 200, 100) @ np.array([0, 0, depth_m, 1.0])
    stored = np.array([(clip[2] / clip[3] + 1) / 2])

    np.testing.assert_allclose(depth_of(stored), [depth_m], rtol=1e-4)


def test_where_nothing_was_drawn_depth_is_infinite() -> None:
    assert np.isinf(depth_of(np.ones(1, dtype=np.float32)))[0]


def test_what_a_camera_may_see() -> None:
    world_SE3_camera = se3(np.eye(3), [10.0, 0.0, 0.0])
    planes = frustum_planes(camera_projection(INTRINSICS, 200, 100) @ invert_se3(world_SE3_camera))
    centers = np.array([
        (10.0, 0.0, 20.0),  # ahead
        (10.0, 0.0, -20.0),  # behind
        (10.0 + 40.0, 0.0, 20.0),  # far to the right: the image ends 120 px, 24 m, from the axis
        (10.0 + 25.0, 0.0, 20.0),  # just outside, but a ball of 2 m reaches in
    ])  # fmt: skip

    assert in_frustum(planes, centers, 2.0).tolist() == [True, False, False, True]


def test_the_sun_looks_down_on_the_middle() -> None:
    direction = np.array([0.6, 0.0, 0.8])
    middle = np.array([100.0, 50.0, 1.0])
    sun = sun_projection(direction, middle, 40.0, 2048)

    place = sun @ np.array([*middle, 1.0])
    along = sun @ np.array([*(middle + 30.0 * direction), 1.0])
    np.testing.assert_allclose(place[:2], 0.0, atol=1 / 2048)  # moved by less than a pixel
    np.testing.assert_allclose(along[:2], place[:2], atol=1e-9)  # what lies along the light falls on one place
    assert along[2] < place[2]  # and what is nearer to the sun hides what is not


def test_what_the_suns_map_covers() -> None:
    sun = sun_projection(np.array([0.0, 0.6, 0.8]), np.zeros(3), 40.0, 1024)
    centers = np.array([(0.0, 0.0, 0.0), (39.0, 0.0, 0.0), (43.0, 0.0, 0.0), (60.0, 0.0, 0.0)])

    assert in_sun_map(sun, centers, 5.0, 40.0).tolist() == [True, True, True, False]
