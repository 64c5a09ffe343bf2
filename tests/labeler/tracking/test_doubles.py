"""Which of two tracks' boxes lie on one object, on boxes laid out by hand."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labeler.tracking.config import TrackingConfig
from labeler.tracking.doubles import SeenBoxes, are_doubles

CONFIG = TrackingConfig()
SIDE_PX = 100.0


def seen(*tracks: tuple[dict[int, float], float], groups: tuple[int, ...] = (0, 0, 0)) -> SeenBoxes:
    """A track as where its square box begins by frame, and the score of each of its boxes."""
    rows = [(number, frame, x, score) for number, (places, score) in enumerate(tracks) for frame, x in places.items()]
    x = np.array([row[2] for row in rows])
    return SeenBoxes(
        track=np.array([row[0] for row in rows], np.int64),
        frame=np.array([row[1] for row in rows], np.int64),
        xyxy_px=np.stack([x, np.zeros_like(x), x + SIDE_PX, np.full_like(x, SIDE_PX)], axis=1),
        score=np.array([row[3] for row in rows]),
        group=np.array(groups[: len(tracks)], np.int64),
    )


def still(x: float, *frames: int) -> dict[int, float]:
    return dict.fromkeys(frames, x)


def dropped(boxes: SeenBoxes) -> set[tuple[int, int]]:
    """(track, frame) of the boxes that are doubles."""
    rows = np.flatnonzero(are_doubles(boxes, CONFIG))
    return set(zip(boxes.track[rows].tolist(), boxes.frame[rows].tolist(), strict=True))


@pytest.mark.parametrize(
    ("boxes", "expected"),
    [
        # shifted by 20 px of 100: IoU 80 / 120
        (seen((still(0, 0, 1, 2), 0.9), (still(20, 0, 1, 2), 0.4)), {(1, 0), (1, 1), (1, 2)}),
        # whichever number it has, the one that was seen worse loses its boxes
        (seen((still(0, 0, 1, 2), 0.4), (still(20, 0, 1, 2), 0.9)), {(0, 0), (0, 1), (0, 2)}),
        # only those that lie on the other: it goes on alone in frame 3
        (seen((still(0, 0, 1, 2), 0.9), (still(20, 1, 2, 3), 0.4)), {(1, 1), (1, 2)}),
        # shifted by half: IoU 1 / 3, two objects one beside the other
        (seen((still(0, 0, 1), 0.9), (still(50, 0, 1), 0.4)), set[tuple[int, int]]()),
        # one passes the other: in one of five frames they are on top of each other
        (seen((still(0, *range(5)), 0.9), ({f: 60.0 * (f - 2) for f in range(5)}, 0.4)), set[tuple[int, int]]()),
        # of other classes that no detector confuses
        (seen((still(0, 0, 1), 0.9), (still(0, 0, 1), 0.4), groups=(0, 1)), set[tuple[int, int]]()),
        # never in one frame
        (seen((still(0, 0, 2), 0.9), (still(0, 1, 3), 0.4)), set[tuple[int, int]]()),
        # three on one object: the best stays
        (seen((still(0, 0), 0.5), (still(5, 0), 0.9), (still(10, 0), 0.7)), {(0, 0), (2, 0)}),
    ],
)
def test_a_double_is_on_the_other_whenever_both_are_there(boxes: SeenBoxes, expected: set[tuple[int, int]]):
    assert dropped(boxes) == expected


def test_boxes_that_were_filled_in_count_for_nothing():
    places = still(0, 0, 1, 2)
    boxes = seen((places, np.nan), (places, 0.3))
    assert dropped(boxes) == {(0, 0), (0, 1), (0, 2)}


def test_no_boxes_have_no_doubles():
    assert len(are_doubles(seen(), CONFIG)) == 0


@settings(max_examples=60)
@given(st.lists(st.tuples(st.integers(0, 4), st.integers(0, 3), st.integers(0, 30)), unique_by=lambda row: row[:2]))
def test_pairs_are_found_as_by_looking_at_all(rows: list[tuple[int, int, int]]):
    """Each box that goes lies on one that overlaps it, of the same frame; the best track of all loses none."""
    tracks = [{frame: 10.0 * x for number, frame, x in rows if number == track} for track in range(5)]
    boxes = seen(*[(places, 0.9 - 0.1 * track) for track, places in enumerate(tracks)], groups=(0,) * 5)
    gone = are_doubles(boxes, CONFIG)
    for row in np.flatnonzero(gone).tolist():
        beside = (boxes.frame == boxes.frame[row]) & (boxes.track != boxes.track[row])
        assert (np.abs(boxes.xyxy_px[beside, 0] - boxes.xyxy_px[row, 0]) < SIDE_PX / 2).any()
    totals = np.bincount(boxes.track, boxes.score, minlength=5)
    if len(rows):
        assert not gone[boxes.track == int(totals.argmax())].any()
