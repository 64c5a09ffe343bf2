"""Colour histograms, on images painted by hand."""

import math

import numpy as np
import pytest

from labeler.identity.colours import BINS, LOOKS_PER_TRACK, best_looks, colour_histogram, likeness
from labeler.tracking.types import NO_DETECTION, Observations

RED, BLUE, GREY, DARK_GREY = (30, 30, 200), (200, 60, 30), (128, 128, 128), (100, 100, 100)
BOX = (20.0, 20.0, 60.0, 60.0)


def painted(inside: tuple[int, int, int], around: tuple[int, int, int] = (0, 0, 0)) -> np.ndarray:
    """An image (80, 80, 3) of one colour with a square of another at BOX."""
    image = np.full((80, 80, 3), around, np.uint8)
    image[20:60, 20:60] = inside
    return image


def observations(*rows: tuple[int, int, float, float]) -> Observations:
    """Rows of track, frame, score and side of a square box in pixels; a score of NaN is a box that was filled in."""
    side = np.array([row[3] for row in rows], np.float32)
    score = np.array([row[2] for row in rows], np.float32)
    return Observations(
        track_id=np.array([row[0] for row in rows], np.int32),
        frame_index=np.array([row[1] for row in rows], np.int32),
        xyxy_px=np.stack([np.zeros_like(side), np.zeros_like(side), side, side], axis=1),
        score=score,
        class_id=np.zeros(len(rows), np.int16),
        detection_index=np.where(np.isnan(score), NO_DETECTION, 0).astype(np.int32),
    )


def test_shares_of_colours_add_up_to_one():
    histogram = colour_histogram(painted(RED), BOX)
    assert histogram is not None
    assert histogram.shape == (BINS,)
    assert histogram.sum() == pytest.approx(1, abs=1e-5)


@pytest.mark.parametrize(
    ("one", "other", "least", "most"),
    [
        (RED, RED, 1, 1),  # the same colour
        (RED, BLUE, 0, 0.01),  # another one
        (GREY, DARK_GREY, 0.6, 0.99),  # the same under another exposure
        (RED, GREY, 0, 0.5),
    ],
)
def test_colours_are_alike_as_they_look(one: tuple, other: tuple, least: float, most: float):
    alike = likeness(colour_histogram(painted(one), BOX), colour_histogram(painted(other), BOX))
    assert least - 1e-5 <= alike <= most + 1e-5


def test_what_is_around_an_object_does_not_count():
    on_black, on_blue = (colour_histogram(painted(RED, around), BOX) for around in ((0, 0, 0), BLUE))
    wider = tuple(np.add(BOX, (-5, -5, 5, 5)))
    assert likeness(on_black, on_blue) == pytest.approx(1, abs=1e-5)
    assert likeness(on_black, colour_histogram(painted(RED, BLUE), wider)) == pytest.approx(1, abs=1e-5)


@pytest.mark.parametrize(
    "box",
    [
        (90.0, 0.0, 120.0, 30.0),  # beside the image
        (10.0, 10.0, 11.0, 40.0),  # too narrow
        (50.0, 50.0, 50.0, 50.0),  # nothing at all
        (60.0, 20.0, 20.0, 60.0),  # inside out
    ],
)
def test_a_box_that_shows_nothing_has_no_colours(box: tuple[float, ...]):
    assert colour_histogram(painted(RED), box) is None
    assert math.isnan(likeness(None, colour_histogram(painted(RED), BOX)))


def test_a_box_that_leaves_the_image_shows_what_is_inside():
    assert colour_histogram(painted(RED, RED), (-20.0, 20.0, 40.0, 60.0)) is not None


def test_the_best_looks_are_large_and_sure_ones():
    many = observations(*[(1, frame, 0.5 + frame / 100, 20) for frame in range(20)])
    few = observations((2, 0, 0.9, 10), (2, 1, 0.8, 50), (2, 2, math.nan, 60))

    looks = best_looks([many, few])

    assert sorted(look.frame_index for look in looks[1]) == list(range(20 - LOOKS_PER_TRACK, 20))
    assert [look.frame_index for look in sorted(looks[2], reverse=True)] == [1, 0]
