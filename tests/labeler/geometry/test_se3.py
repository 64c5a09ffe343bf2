"""Rigid motions: hand-computed tables and properties."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labeler.geometry.se3 import (
    interpolate_se3,
    invert_se3,
    se3,
    se3_from_quaternion,
    transform_points,
    yaw_of,
)

_component = st.floats(-1, 1)
_quaternion = st.tuples(_component, _component, _component, _component).filter(lambda q: math.hypot(*q) > 0.1)
_translation = st.tuples(*[st.floats(-1e4, 1e4)] * 3)
_motion = st.builds(lambda q, t: se3_from_quaternion(q[0], q[1], q[2], q[3], t), _quaternion, _translation)
_HALF = math.sqrt(0.5)


@pytest.mark.parametrize(
    ("quaternion", "expected"),
    [
        ((1, 0, 0, 0), [1, 2, 3]),  # no turn
        ((_HALF, 0, 0, _HALF), [-2, 1, 3]),  # a quarter turn about z: x goes to y
        ((_HALF, _HALF, 0, 0), [1, -3, 2]),  # about x: y goes to z
        ((_HALF, 0, _HALF, 0), [3, 2, -1]),  # about y: z goes to x
        ((2, 0, 0, 2), [-2, 1, 3]),  # of length 2.8: the same as of length 1
        ((-_HALF, 0, 0, -_HALF), [-2, 1, 3]),  # the opposite quaternion is the same turn
    ],
)
def test_quaternion_turns_a_point(quaternion: tuple[float, float, float, float], expected: list[float]) -> None:
    turned = transform_points(se3_from_quaternion(*quaternion, [10, 20, 30]), np.array([[1.0, 2.0, 3.0]]))
    np.testing.assert_allclose(turned[0], np.add(expected, [10, 20, 30]), atol=1e-12)


@pytest.mark.parametrize(
    ("quaternion", "translation", "message"),
    [
        ((0, 0, 0, 0), (0, 0, 0), "zero"),  # no turn at all can be read from it
        ((math.nan, 0, 0, 1), (0, 0, 0), "not finite"),
        ((math.inf, 0, 0, 1), (0, 0, 0), "not finite"),
        ((1, 0, 0, 0), (0, math.nan, 0), "not finite"),
    ],
)
def test_refuses_what_is_no_motion(
    quaternion: tuple[float, float, float, float], translation: tuple[float, float, float], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        se3_from_quaternion(*quaternion, translation)


@pytest.mark.parametrize("degrees", [0, 30, 90, 179, -179, -45])
def test_yaw(degrees: float) -> None:
    half = math.radians(degrees) / 2
    assert math.degrees(yaw_of(se3_from_quaternion(math.cos(half), 0, 0, math.sin(half), [5, 6, 7]))) == (
        pytest.approx(degrees)
    )


def _turned(degrees: float, x_m: float) -> np.ndarray:
    half = math.radians(degrees) / 2
    return se3_from_quaternion(math.cos(half), 0, 0, math.sin(half), [x_m, 0, 0])


@pytest.mark.parametrize(
    ("time_ns", "yaw_degrees", "x_m"),
    [
        (50, 0, 0),  # before the first: the first
        (100, 0, 0),  # at the first
        (150, 20, 5),  # in the middle
        (125, 10, 2.5),  # a quarter
        (200, 40, 10),  # at the second
        (300, 40, 30),  # between two of the same turn
        (900, 40, 50),  # after the last: the last
    ],
)
def test_interpolation(time_ns: int, yaw_degrees: float, x_m: float) -> None:
    base_ns = 1_556_919_593_841_523_000  # nanoseconds since 1970 do not fit a float64
    times_ns = np.array([100, 200, 400], dtype=np.int64) + base_ns
    poses = np.stack([_turned(0, 0), _turned(40, 10), _turned(40, 50)])
    pose = interpolate_se3(times_ns, poses, np.array([base_ns + time_ns]))[0]
    assert math.degrees(yaw_of(pose)) == pytest.approx(yaw_degrees)
    assert pose[0, 3] == pytest.approx(x_m)


def test_interpolation_takes_the_short_way_round() -> None:
    pose = interpolate_se3(np.array([0, 10]), np.stack([_turned(170, 0), _turned(-170, 0)]), np.array([5]))[0]
    assert abs(math.degrees(yaw_of(pose))) == pytest.approx(180)


def test_a_pose_at_the_ends_is_a_copy() -> None:
    poses = np.stack([np.eye(4), np.eye(4)])
    interpolate_se3(np.array([0, 10]), poses, np.array([-5, 0, 10, 15]))[:, 0, 3] = 99.0
    assert poses[:, 0, 3].tolist() == [0.0, 0.0]


@given(_motion)
def test_a_motion_and_its_inverse_cancel(a_SE3_b: np.ndarray) -> None:
    np.testing.assert_allclose(a_SE3_b @ invert_se3(a_SE3_b), np.eye(4), atol=1e-8)
    np.testing.assert_allclose(invert_se3(invert_se3(a_SE3_b)), a_SE3_b, atol=1e-8)


@given(_motion, _motion, _translation)
def test_two_motions_in_a_row_are_their_product(a_SE3_b: np.ndarray, b_SE3_c: np.ndarray, point: tuple) -> None:
    points_c = np.array([point])
    step_by_step = transform_points(a_SE3_b, transform_points(b_SE3_c, points_c))
    np.testing.assert_allclose(transform_points(a_SE3_b @ b_SE3_c, points_c), step_by_step, atol=1e-7)


@given(_motion, _translation, _translation)
def test_a_motion_keeps_distances(a_SE3_b: np.ndarray, first: tuple, second: tuple) -> None:
    moved = transform_points(a_SE3_b, np.array([first, second]))
    before_m = math.dist(first, second)
    assert np.linalg.norm(moved[0] - moved[1]) == pytest.approx(before_m, abs=1e-7)


@given(_motion, _motion, st.integers(0, 1000))
def test_interpolation_gives_a_rigid_motion(first: np.ndarray, second: np.ndarray, time_ns: int) -> None:
    pose = interpolate_se3(np.array([0, 1000]), np.stack([first, second]), np.array([time_ns]))[0]
    np.testing.assert_allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-9)
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1)
    np.testing.assert_allclose(pose[3], [0, 0, 0, 1])


def test_no_points_stay_no_points() -> None:
    assert transform_points(se3(np.eye(3), [1, 2, 3]), np.zeros((0, 3))).shape == (0, 3)
