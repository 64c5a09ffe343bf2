"""Physics checks on ways made by hand."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from app.motion.checks import Check, Failure, distances_m, failures
from app.motion.paths import BoxPath, PathFrame


def _path(
    xy_m: Sequence[tuple[float, float]],
    *,
    yaw_deg: Sequence[float] | None = None,
    size_m: Sequence[tuple[float, float]] | None = None,
    first_frame: int = 0,
    frame: PathFrame = PathFrame.CITY,
) -> BoxPath:
    """A box each tenth of a second; by default a car of 4 x 2 m that looks along x."""
    count = len(xy_m)
    frames = np.arange(first_frame, first_frame + count)
    lengths = np.array(size_m if size_m is not None else [(4.0, 2.0)] * count)
    return BoxPath(
        frame_index=frames,
        time_s=frames / 10,
        xy_m=np.array(xy_m, np.float64),
        yaw_rad=np.radians(np.array(yaw_deg if yaw_deg is not None else [0.0] * count)),
        size_m=np.column_stack([lengths, np.full(count, 1.5)]),
        ego_distance_m=np.hypot(*np.array(xy_m, np.float64).T),
        frame=frame,
    )


STILL = [(10.0, 0.0)] * 12


def _line(speed_mps: float, count: int = 12) -> list[tuple[float, float]]:
    return [(speed_mps * frame / 10, 0.0) for frame in range(count)]


@pytest.mark.parametrize(
    ("speed_mps", "class_name", "fails"),
    [
        (50.0, "car", False),  # 180 km/h
        (80.0, "car", True),  # 288 km/h
        (10.0, "person", False),  # a sprint
        (15.0, "person", True),
        (20.0, "bicycle", False),
        (30.0, "bicycle", True),
    ],
)
def test_speed_is_limited_by_class(speed_mps: float, class_name: str, fails: bool) -> None:
    found = failures([_path(_line(speed_mps))], class_name, None)
    assert [(failure.check, failure.value) for failure in found] == ([(Check.SPEED, speed_mps)] if fails else [])


def test_a_wrong_merge_jumps_from_one_track_to_the_other() -> None:
    here, there = _path(STILL[:6]), _path([(60.0, 0.0)] * 6, first_frame=6)
    # 50 m from frame 5 to 6; a speed is taken over half a second: 100 m/s, first reached in frame 6
    assert failures([here, there], "car", None) == [Failure(Check.SPEED, 100.0, "m/s", 6)]


def test_a_jump_across_a_long_gap_is_no_speed() -> None:
    assert failures([_path(STILL[:6]), _path([(60.0, 0.0)] * 6, first_frame=40)], "car", None) == []


def test_without_poses_speed_and_turns_are_not_known() -> None:
    turned = _path(_line(80.0), yaw_deg=[0] * 6 + [90] * 6, frame=PathFrame.EGO)
    assert failures([turned], "car", None) == []


@pytest.mark.parametrize(
    ("sizes", "ratio"),
    [
        ([(4.0, 2.0)] * 12, None),
        ([(1.0, 1.8)] * 6 + [(4.5, 1.8)] * 6, None),  # from behind, then whole: 2.06 to 4.85 m
        ([(3.0, 4.0)] * 6 + [(9.0, 12.0)] * 6, None),  # exactly 3 times
        ([(3.0, 4.0)] * 6 + [(12.0, 16.0)] * 6, 4.0),  # 5 to 20 m
        ([(3.0, 4.0)] * 3 + [(12.0, 16.0)] * 3, None),  # too few boxes to tell
        ([(3.0, 4.0)] * 11 + [(12.0, 16.0)], None),  # a single one is chance
    ],
)
def test_size_drift(sizes: list[tuple[float, float]], ratio: float | None) -> None:
    found = failures([_path(STILL[: len(sizes)], size_m=sizes)], "car", None)
    assert [(failure.check, failure.value) for failure in found] == ([] if ratio is None else [(Check.SIZE, ratio)])


@pytest.mark.parametrize(
    ("yaws", "turn"),
    [
        ([0] * 6 + [80] * 6, 80.0),
        ([0] * 6 + [50] * 6, None),
        ([0] * 6 + [180] * 6, None),  # front and rear are not told apart
        ([0] * 6 + [-100] * 6, 80.0),  # by half turns
        ([10 * frame for frame in range(12)], None),  # a steady bend
        ([0] * 5 + [90] + [0] * 6, None),  # a single loose box
        ([0, 90] * 6, None),  # boxes without a direction say nothing
    ],
)
def test_yaw_jump(yaws: list[float], turn: float | None) -> None:
    found = failures([_path(STILL, yaw_deg=yaws)], "car", None)
    assert [(failure.check, failure.value, failure.frame_index) for failure in found] == (
        [] if turn is None else [(Check.YAW, turn, 6)]
    )


def test_twice_in_a_camera_is_told_by_its_frame() -> None:
    assert failures([], "car", 7) == [Failure(Check.TWICE, 2, "boxes", 7)]


def test_distances() -> None:
    assert distances_m([_path([(3.0, 4.0), (6.0, 8.0)]), _path([(0.0, 2.0)])]) == (2.0, 10.0)
    assert distances_m([]) == (None, None)
    assert math.isclose(distances_m([_path([(30.0, 40.0)])])[0] or 0.0, 50.0)
