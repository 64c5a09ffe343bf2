import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labeler.lidar import LidarConfig
from labeler.lidar.l_shape import extents_along, fit_yaws

CONFIG = LidarConfig()


def two_sides(yaw_deg: float, *, length_m: float = 4.5, width_m: float = 1.9) -> np.ndarray:
    """The L that two sides of a car draw, seen from above."""
    along = np.stack([np.linspace(0, length_m, 60), np.zeros(60)], axis=1)
    across = np.stack([np.zeros(30), np.linspace(0, width_m, 30)], axis=1)
    yaw_rad = np.radians(yaw_deg)
    turn = np.array([[np.cos(yaw_rad), -np.sin(yaw_rad)], [np.sin(yaw_rad), np.cos(yaw_rad)]])
    return np.concatenate([along, across]) @ turn.T + [12.0, -3.0]


@given(st.floats(0, 89))
def test_the_yaw_of_an_l_is_found(yaw_deg: float):
    xy_m = two_sides(yaw_deg)
    found_deg = np.degrees(fit_yaws(xy_m, np.array([0, len(xy_m)]), CONFIG)[0])
    assert abs((found_deg - yaw_deg + 45) % 90 - 45) <= CONFIG.yaw_step_deg


def test_clusters_are_fitted_one_by_one():
    parts = [two_sides(10), two_sides(60)]
    xy_m, start = np.concatenate(parts), np.array([0, len(parts[0]), len(parts[0]) + len(parts[1])])
    yaw_rad = fit_yaws(xy_m, start, CONFIG)
    np.testing.assert_allclose(np.degrees(yaw_rad), [10, 60], atol=2)
    low_m, high_m = extents_along(xy_m, start, yaw_rad, outliers=0.0)
    np.testing.assert_allclose(high_m - low_m, [[4.5, 1.9], [4.5, 1.9]], atol=0.15)


def test_a_far_outlier_does_not_stretch_the_extent():
    xy_m = np.concatenate([two_sides(0), [[30.0, -3.0]]])
    low_m, high_m = extents_along(xy_m, np.array([0, len(xy_m)]), np.zeros(1), outliers=0.02)
    assert (high_m - low_m)[0, 0] == pytest.approx(4.5, abs=0.2)


def test_no_clusters_give_no_yaws():
    assert fit_yaws(np.zeros((0, 2)), np.zeros(1, np.int64), CONFIG).shape == (0,)
