"""Which true object a track shows, on boxes laid out by hand."""

import numpy as np
import pytest

from labeler.drive.types import TruthBoxes2D
from labeler.evaluation.owners import objects_of_tracks, true_identities
from labeler.tracking.types import NO_DETECTION, Observations

PLACE_PX = {"a": 0.0, "b": 100.0, "nothing": 200.0}
FRAMES = 10


def boxes_px(places: list[str]) -> np.ndarray:
    return np.array([[PLACE_PX[place], 0, PLACE_PX[place] + 40, 40] for place in places], np.float32)


TRUTH = TruthBoxes2D(
    frame_index=np.repeat(np.arange(FRAMES, dtype=np.int32), 2),
    camera=("front",) * (2 * FRAMES),
    track_uuid=("a", "b") * FRAMES,
    category=("CAR",) * (2 * FRAMES),
    xyxy_px=boxes_px(["a", "b"] * FRAMES),
)


def track(track_id: int, places: list[str]) -> Observations:
    """A track that lies on one of the places in each frame."""
    count = len(places)
    return Observations(
        np.full(count, track_id, np.int32),
        np.arange(count, dtype=np.int32),
        boxes_px(places),
        np.full(count, 0.9, np.float32),
        np.zeros(count, np.int16),
        np.full(count, NO_DETECTION, np.int32),
    )


@pytest.mark.parametrize(
    ("places", "shown"),
    [
        (["a"] * 10, {5: "a"}),
        (["a"] * 5 + ["nothing"] * 5, {5: "a"}),  # half of its boxes are enough
        (["a"] * 4 + ["nothing"] * 6, {}),  # less is unclear
        (["a"] * 7 + ["b"] * 3, {5: "a"}),
        (["a"] * 6 + ["b"] * 4, {}),  # it shows both
        (["nothing"] * 10, {5: None}),
        (["nothing"] * 9 + ["a"], {5: None}),  # a stray box
    ],
)
def test_a_track_shows_what_most_of_its_boxes_show(places: list[str], shown: dict[int, str | None]):
    assert objects_of_tracks(TRUTH, {"front": [track(5, places)]}) == shown


def test_all_tracks_of_one_object_are_one_identity():
    assert true_identities({7: "a", 3: "a", 4: None, 9: "b"}) == {3: 3, 7: 3, 9: 9}
