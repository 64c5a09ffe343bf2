"""Scores of a segmentation: read at places in the image, and checked when made."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labeler.segmentation import SegmentationScores

ROAD_AND_CAR = ("road", "car")


def made_scores() -> SegmentationScores:
    """Two rows and three columns of 4 px cells over an image of 11 x 8 px; road is what car is not."""
    car = np.array([[0, 255, 51], [0, 0, 102]], np.uint8)
    return SegmentationScores(ROAD_AND_CAR, np.stack([255 - car, car]), stride_px=4.0, size_px=(11, 8))


@pytest.mark.parametrize(
    ("x", "y", "car"),
    [
        (2, 2, 0.0),  # the centre of the first cell
        (6, 2, 1.0),  # the centre of the second
        (4, 2, 0.5),  # half-way between them
        (3, 2, 0.25),  # a quarter of the way
        (6, 4, 0.5),  # half-way down
        (4, 4, 0.25),  # in the middle of four: (0 + 255 + 0 + 0) / 4
        (0, 0, 0.0),  # before the first centre nothing is extrapolated
        (10.5, 7.9, 0.4),  # nor behind the last: 102 / 255
        (7, 2, 1 - 0.25 * 0.8),  # from 1 towards 51 / 255
    ],
)
def test_scores_are_interpolated_between_the_centres_of_cells(x: float, y: float, car: float) -> None:
    found = made_scores().at(np.array([[x, y]]))
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, [[1 - car, car]], atol=1e-6)


@pytest.mark.parametrize(
    "pixel",
    [(-0.1, 2), (2, -0.1), (11, 2), (2, 8), (np.nan, 2), (2, np.nan), (np.inf, 2), (1e300, 2)],
)
def test_places_outside_of_the_image_score_nothing(pixel: tuple[float, float]) -> None:
    np.testing.assert_array_equal(made_scores().at(np.array([pixel, (6, 2)])), [[0, 0], [0, 1]])


def test_groups_of_classes_are_summed() -> None:
    pixels = np.array([[4, 2], [6, 2], [-1, 2]], np.float32)
    found = made_scores().sums_at(pixels, [(1,), (0, 1)])
    np.testing.assert_allclose(found, [[0.5, 1], [1, 1], [0, 0]], atol=1e-6)


def test_no_places_give_no_rows() -> None:
    assert made_scores().at(np.zeros((0, 2), np.float32)).shape == (0, 2)


@given(st.lists(st.tuples(st.floats(0, 10.99), st.floats(0, 7.99)), min_size=1, max_size=20))
def test_scores_of_a_place_in_the_image_sum_to_one(places: list[tuple[float, float]]) -> None:
    np.testing.assert_allclose(made_scores().at(np.array(places, np.float32)).sum(axis=1), 1, atol=1e-5)


@pytest.mark.parametrize(
    ("shape", "dtype", "stride_px", "size_px", "complaint"),
    [
        ((3, 2, 3), np.uint8, 4.0, (10, 8), "a plane for each class"),
        ((2, 2, 3), np.float32, 4.0, (10, 8), "uint8"),
        ((2, 6), np.uint8, 4.0, (10, 8), "a plane for each class"),
        ((2, 2, 3), np.uint8, 0.0, (10, 8), "stride_px must be above 0"),
        ((2, 2, 3), np.uint8, float("nan"), (10, 8), "stride_px must be above 0"),
        ((2, 2, 3), np.uint8, 4.0, (13, 8), "do not cover"),
        ((2, 2, 3), np.uint8, 4.0, (12, 9), "do not cover"),
        ((2, 2, 3), np.uint8, 4.0, (0, 8), "do not cover"),
    ],
)
def test_what_does_not_fit_together_is_refused(
    shape: tuple[int, ...], dtype: Any, stride_px: float, size_px: tuple[int, int], complaint: str
) -> None:
    with pytest.raises(ValueError, match=complaint):
        SegmentationScores(ROAD_AND_CAR, np.zeros(shape, dtype), stride_px=stride_px, size_px=size_px)


def test_classes_are_found_by_name() -> None:
    scores = made_scores()
    assert (scores.class_index("Car"), scores.class_index("road"), scores.class_index("sky")) == (1, 0, None)
