"""Upright boxes in 3D: hand-computed tables and properties."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labeler.geometry.boxes_3d import bev_intersection, bev_iou_limit, corners_of, iou_3d

_metres = st.floats(-60, 60)
_size = st.tuples(st.floats(0.3, 12), st.floats(0.3, 4), st.floats(0.3, 4)).map(np.array)
_center = st.tuples(_metres, _metres, st.floats(-3, 3)).map(np.array)
_yaw = st.floats(-7, 7)
_CAR = np.array([4.0, 2.0, 1.5])


@pytest.mark.parametrize(
    ("yaw_rad", "expected_xy"),
    [
        (0.0, {(3, 3), (3, 1), (-1, 3), (-1, 1)}),  # length along x
        (math.pi / 2, {(0, 4), (2, 4), (0, 0), (2, 0)}),  # a quarter turn: length along y
        (math.pi, {(3, 3), (3, 1), (-1, 3), (-1, 1)}),  # half a turn: the same corners
    ],
)
def test_corners(yaw_rad: float, expected_xy: set[tuple[int, int]]) -> None:
    corners = corners_of(np.array([[1.0, 2.0, 3.0]]), _CAR[None], np.array([yaw_rad]))[0]
    assert {(round(x), round(y)) for x, y, _ in corners} == expected_xy
    assert sorted(corners[:, 2].tolist()) == [2.25] * 4 + [3.75] * 4


def test_yaw_turns_from_x_towards_y() -> None:
    corners = corners_of(np.zeros((1, 3)), np.array([[2.0, 0.0, 0.0]]), np.array([math.pi / 6]))[0]
    assert corners[0, :2].tolist() == pytest.approx([math.cos(math.pi / 6), 0.5])


def test_no_boxes_have_no_corners() -> None:
    assert corners_of(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0)).shape == (0, 8, 3)


@pytest.mark.parametrize(
    ("center_b", "size_b", "yaw_b", "expected_m2"),
    [
        ([0, 0, 0], [4, 2, 1.5], 0.0, 8.0),  # the same
        ([2, 0, 0], [4, 2, 1.5], 0.0, 4.0),  # half a length ahead
        ([0, 1, 0], [4, 2, 1.5], 0.0, 4.0),  # half a width to the left
        ([4, 0, 0], [4, 2, 1.5], 0.0, 0.0),  # bumper to bumper
        ([9, 9, 0], [4, 2, 1.5], 0.3, 0.0),  # apart
        ([0, 0, 0], [4, 2, 1.5], math.pi / 2, 4.0),  # crossed
        ([0, 0, 9], [1, 1, 1.5], 0.0, 1.0),  # inside; the height does not matter here
        ([0, 0, 0], [math.sqrt(2), math.sqrt(2), 1], math.pi / 4, 2.0),  # a diamond inside, its tips on the sides
        ([0, 0, 0], [0, 0, 0], 0.0, 0.0),  # a point
    ],
)
def test_bev_intersection_with_a_car_at_the_origin(
    center_b: list[float], size_b: list[float], yaw_b: float, expected_m2: float
) -> None:
    shared = bev_intersection(np.zeros(3), _CAR, 0.0, np.array(center_b, float), np.array(size_b, float), yaw_b)
    assert shared == pytest.approx(expected_m2, abs=1e-5)


@pytest.mark.parametrize(
    ("center_b", "expected"),
    [
        ([0, 0, 0], (1.0, 1.0)),  # the same
        ([2, 0, 0], (1 / 3, 1 / 3)),  # half a length ahead
        ([0, 0, 0.75], (1 / 3, 1.0)),  # half a height above
        ([2, 0, 0.75], (1 / 7, 1 / 3)),  # 3 of 12 + 12 - 3 cubic metres
        ([0, 0, 1.5], (0.0, 1.0)),  # on its roof
        ([0, 0, 5], (0.0, 1.0)),  # above with a gap
    ],
)
def test_iou_3d(center_b: list[float], expected: tuple[float, float]) -> None:
    assert iou_3d(np.zeros(3), _CAR, 0.0, np.array(center_b, float), _CAR, 0.0) == pytest.approx(expected, abs=1e-5)


def test_overlap_of_two_empty_boxes_is_0() -> None:
    assert iou_3d(np.zeros(3), np.zeros(3), 0.0, np.zeros(3), np.zeros(3), 0.0) == (0.0, 0.0)


@given(_center, _size, _yaw, _center, _size, _yaw)
def test_overlap_is_symmetric_and_between_0_and_1(center_a, size_a, yaw_a, center_b, size_b, yaw_b) -> None:
    near_b = center_a + center_b / 20
    forth = iou_3d(center_a, size_a, yaw_a, near_b, size_b, yaw_b)
    back = iou_3d(near_b, size_b, yaw_b, center_a, size_a, yaw_a)
    assert forth == pytest.approx(back, abs=2e-4)
    assert all(0 <= value <= 1.0001 for value in forth)


@given(_center, _size, _yaw)
def test_overlap_with_itself_is_1(center, size, yaw) -> None:
    assert iou_3d(center, size, yaw, center, size, yaw) == pytest.approx((1, 1), abs=1e-4)


@given(_center, _size, _yaw, st.sampled_from([1e3, 4e5, 5e6]))
def test_overlap_is_the_same_at_city_coordinates(center, size, yaw, city_m) -> None:
    other, city = center + np.array([0.7, -0.4, 0.1]), np.array([city_m, -city_m, 0.0])
    here = iou_3d(center, size, yaw, other, size, yaw + 0.2)
    there = iou_3d(center + city, size, yaw, other + city, size, yaw + 0.2)
    assert there == pytest.approx(here, abs=1e-4)


@given(_center, _size, _yaw)
def test_corners_stand_half_a_diagonal_from_the_centre(center, size, yaw) -> None:
    corners = corners_of(center[None], size[None], np.array([yaw]))[0]
    np.testing.assert_allclose(np.linalg.norm(corners - center, axis=1), np.linalg.norm(size) / 2)
    np.testing.assert_allclose(corners.mean(axis=0), center, atol=1e-9)


_box = st.tuples(_center, _size, _yaw)


@given(st.lists(_box, min_size=1, max_size=5))
def test_no_two_boxes_overlap_more_than_their_limit(boxes: list[tuple[np.ndarray, np.ndarray, float]]) -> None:
    center_m, size_m, yaw_rad = (np.array(column) for column in zip(*boxes, strict=True))
    center_m[:, :2] /= 10  # close enough to meet
    limit = bev_iou_limit(center_m, size_m, yaw_rad)
    for a in range(len(boxes)):
        for b in range(len(boxes)):
            found = iou_3d(center_m[a], size_m[a], yaw_rad[a], center_m[b], size_m[b], yaw_rad[b])[1]
            assert found <= limit[a, b] + 1e-4


@pytest.mark.parametrize(
    ("center_b", "yaw_b", "limit"),
    [
        ([0, 0, 0], 0.0, 1.0),  # the same
        ([2, 0, 0], 0.0, 1 / 3),  # half a length ahead: 4 of 12
        ([4, 0, 0], 0.0, 0.0),  # bumper to bumper
        ([0, 2.1, 0], 0.0, 0.0),  # side by side: their circles meet, they don't
        ([0, 0, 5], 0.0, 1.0),  # heights do not matter
    ],
)
def test_limit_of_a_car_at_the_origin_and_another(center_b: list[float], yaw_b: float, limit: float) -> None:
    found = bev_iou_limit(np.array([[0, 0, 0], center_b], float), np.stack([_CAR, _CAR]), np.array([0, yaw_b]))
    np.testing.assert_allclose(found, [[1, limit], [limit, 1]], atol=1e-9)
