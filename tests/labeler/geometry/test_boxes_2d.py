"""Overlap of boxes in images: hand-computed tables and properties."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labeler.geometry.boxes_2d import area, intersection_matrix, iou_matrix

_coordinate = st.integers(-2000, 4000).map(lambda half_px: half_px / 2)
_side = st.integers(1, 2000).map(lambda half_px: half_px / 2)
_box = st.builds(lambda x, y, w, h: [x, y, x + w, y + h], _coordinate, _coordinate, _side, _side)
_boxes = st.lists(_box, min_size=1, max_size=6).map(lambda rows: np.array(rows, dtype=np.float64))


@pytest.mark.parametrize(
    ("box", "expected"),
    [
        ([0, 0, 10, 5], 50.0),
        ([-4, -2, 0, 0], 8.0),  # left of and above the image
        ([3, 3, 3, 9], 0.0),  # no width
        ([10, 0, 0, 5], 0.0),  # left and right swapped
        ([10, 5, 0, 0], 0.0),  # both swapped: two negative sides are no area
    ],
)
def test_area(box: list[float], expected: float) -> None:
    assert area(np.array([box], dtype=np.float32)).tolist() == [expected]


@pytest.mark.parametrize(
    ("a", "b", "expected"),
    [
        ([0, 0, 10, 10], [0, 0, 10, 10], 1.0),  # the same
        ([0, 0, 10, 10], [5, 0, 15, 10], 50 / 150),  # half beside
        ([0, 0, 10, 10], [5, 5, 15, 15], 25 / 175),  # a quarter
        ([0, 0, 10, 10], [2, 2, 4, 4], 4 / 100),  # one inside of the other
        ([0, 0, 10, 10], [10, 0, 20, 10], 0.0),  # a shared edge
        ([0, 0, 10, 10], [11, 11, 12, 12], 0.0),  # apart in both directions
        ([0, 0, 10, 10], [20, 0, 30, 10], 0.0),  # apart in x only
        ([3, 3, 3, 3], [3, 3, 3, 3], 0.0),  # both empty
    ],
)
def test_iou(a: list[float], b: list[float], expected: float) -> None:
    assert iou_matrix(np.array([a], dtype=float), np.array([b], dtype=float))[0, 0] == pytest.approx(expected)


def test_iou_of_whole_number_boxes_is_a_fraction() -> None:
    boxes = np.array([[0, 0, 10, 10], [5, 0, 15, 10]])
    assert iou_matrix(boxes, boxes)[0].tolist() == pytest.approx([1.0, 1 / 3])


def test_iou_keeps_float32_for_speed() -> None:
    boxes = np.zeros((2, 4), dtype=np.float32)
    assert iou_matrix(boxes, boxes).dtype == np.float32


def test_rows_are_the_first_boxes_and_columns_the_second() -> None:
    a = np.array([[0.0, 0, 2, 2], [10, 10, 12, 12]])
    b = np.array([[10.0, 10, 11, 12], [0, 0, 1, 1], [50, 50, 60, 60]])
    assert intersection_matrix(a, b).tolist() == [[0, 1, 0], [2, 0, 0]]


@pytest.mark.parametrize(("count_a", "count_b"), [(0, 0), (0, 3), (2, 0)])
def test_no_boxes_give_an_empty_matrix(count_a: int, count_b: int) -> None:
    assert iou_matrix(np.zeros((count_a, 4)), np.zeros((count_b, 4))).shape == (count_a, count_b)


@given(_boxes, _boxes)
def test_iou_is_symmetric_and_between_0_and_1(a: np.ndarray, b: np.ndarray) -> None:
    iou = iou_matrix(a, b)
    assert ((iou >= 0) & (iou <= 1)).all()
    np.testing.assert_array_equal(iou, iou_matrix(b, a).T)


@given(_boxes)
def test_iou_with_itself_is_1(boxes: np.ndarray) -> None:
    np.testing.assert_array_equal(np.diag(iou_matrix(boxes, boxes)), 1.0)


@given(_boxes, _boxes, _coordinate, _coordinate)
def test_iou_does_not_change_when_both_move(a: np.ndarray, b: np.ndarray, x: float, y: float) -> None:
    shift = np.array([x, y, x, y])
    np.testing.assert_allclose(iou_matrix(a + shift, b + shift), iou_matrix(a, b))


@given(_boxes, _boxes)
def test_shared_area_is_at_most_the_smaller_area(a: np.ndarray, b: np.ndarray) -> None:
    assert (intersection_matrix(a, b) <= np.minimum(area(a)[:, None], area(b)[None, :])).all()
