import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labeler.simulation.tractrix import center_of, jumped, trail, wrapped


def trail_one(before: tuple[float, float], after: tuple[float, float], yaw_rad: float, rear_axle_m: float) -> float:
    return float(
        trail(np.array([before], float), np.array([after], float), np.array([yaw_rad]), np.array([rear_axle_m]))[0]
    )


@pytest.mark.parametrize(
    ("after", "yaw_deg", "rear_axle_m", "expected_deg"),
    [
        # straight ahead: nothing turns
        ((5.0, 0.0), 0.0, 3.0, 0.0),
        # across the motion, after 3 ln 2: tan(a / 2) has halved from 1, so a = 2 atan(0.5)
        ((3.0 * np.log(2.0), 0.0), 90.0, 3.0, 53.130102),
        # the same to the other side
        ((3.0 * np.log(2.0), 0.0), -90.0, 3.0, -53.130102),
        # motion to the north, body to the east: the body turns left, towards 90 degrees
        ((0.0, 3.0 * np.log(2.0)), 0.0, 3.0, 36.869898),
        # standing still: the body keeps its yaw
        ((0.0, 0.0), 37.0, 3.0, 37.0),
        # over the cut at 180 degrees: motion at 180, body at -170 is 10 to the left of it, and stays so
        ((-1e-6, 0.0), -170.0, 3.0, -170.0),
    ],
)
def test_one_straight_move(after: tuple[float, float], yaw_deg: float, rear_axle_m: float, expected_deg: float) -> None:
    assert np.degrees(trail_one((0.0, 0.0), after, np.radians(yaw_deg), rear_axle_m)) == pytest.approx(
        expected_deg, abs=1e-4
    )


@given(st.floats(0.1, 5.0), st.floats(-3.0, 3.0), st.floats(0.5, 8.0), st.floats(0.05, 0.95))
def test_two_moves_along_one_line_are_one(way_m: float, yaw_rad: float, rear_axle_m: float, share: float) -> None:
    middle = (share * way_m, 0.0)
    half_way = trail_one((0.0, 0.0), middle, yaw_rad, rear_axle_m)
    assert trail_one(middle, (way_m, 0.0), half_way, rear_axle_m) == pytest.approx(
        trail_one((0.0, 0.0), (way_m, 0.0), yaw_rad, rear_axle_m), abs=1e-9
    )


def test_on_a_circle_the_rear_axle_runs_on_a_smaller_one() -> None:
    """Front on radius 10, axle 6 behind: the axle settles on radius sqrt(100 - 36) = 8."""
    angles = np.linspace(0.0, 4 * np.pi, 4001)
    front_m = 10.0 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    yaw_rad = np.array([np.pi / 2])
    for before, after in itertools.pairwise(front_m):
        yaw_rad = trail(before[None], after[None], yaw_rad, np.array([6.0]))
    rear_m = front_m[-1] - 6.0 * np.array([np.cos(yaw_rad[0]), np.sin(yaw_rad[0])])
    assert np.hypot(*rear_m) == pytest.approx(8.0, abs=1e-3)


def test_center_lies_half_a_length_behind_the_front() -> None:
    center_m = center_of(np.array([[10.0, 5.0], [0.0, 0.0]]), np.array([0.0, np.pi / 2]), np.array([4.0, 6.0]))
    assert center_m == pytest.approx(np.array([[8.0, 5.0], [0.0, -3.0]]))


def test_a_vehicle_that_is_put_elsewhere_has_jumped() -> None:
    moved = jumped(np.zeros((2, 2)), np.array([[1.4, 0.0], [0.0, 200.0]]))
    assert moved.tolist() == [False, True]


def test_wrapped() -> None:
    angles = np.degrees(wrapped(np.radians(np.array([0.0, 190.0, -190.0, 720.0]))))
    assert angles == pytest.approx([0.0, -170.0, 170.0, 0.0])
