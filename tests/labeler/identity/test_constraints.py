import numpy as np
import pytest

from labeler.identity.constraints import AnchorFinder, Constraints, Decisions, TrackAnchor
from labeler.tracking.types import Observations

BOX = (10.0, 10.0, 30.0, 30.0)
BESIDE = (50.0, 10.0, 70.0, 30.0)


def seen(*tracks: tuple[int, tuple[float, float, float, float]]) -> Observations:
    count = len(tracks)
    return Observations(
        np.array([track for track, _ in tracks], np.int32),
        np.zeros(count, np.int32),
        np.array([box for _, box in tracks], np.float32).reshape(-1, 4),
        np.ones(count, np.float32),
        np.zeros(count, np.int16),
        np.arange(count, dtype=np.int32),
    )


def anchor(*frames: int, camera: str = "front") -> TrackAnchor:
    return TrackAnchor(camera, frames, (BOX,) * len(frames))


def find(wanted: TrackAnchor, frames: dict[int, Observations]) -> int | None:
    finder = AnchorFinder([wanted])
    for frame, observations in frames.items():
        finder.add("front", frame, observations)
    return finder.track_of(wanted)


@pytest.mark.parametrize(
    ("wanted", "frames", "track"),
    [
        (anchor(3), {3: seen((7, BOX), (8, BESIDE))}, 7),
        (anchor(3), {3: seen((8, BESIDE))}, None),  # something else stands there
        (anchor(3), {2: seen((7, BOX))}, None),  # another frame
        (anchor(3, camera="left"), {3: seen((7, BOX))}, None),  # another camera
        # 9 crosses the place once; 7 lies there in two of three frames.
        (anchor(1, 2, 3), {1: seen((7, BOX)), 2: seen((9, BOX)), 3: seen((7, BOX))}, 7),
        # In one of three frames only: chance.
        (anchor(1, 2, 3), {1: seen((7, BOX)), 2: seen((9, BESIDE)), 3: seen((8, BESIDE))}, None),
        # Images in which nothing at all was seen say nothing.
        (anchor(1, 2, 3), {1: seen((7, BOX)), 2: seen(), 3: seen()}, 7),
    ],
)
def test_an_anchor_is_found_by_most_of_its_boxes(
    wanted: TrackAnchor, frames: dict[int, Observations], track: int | None
):
    assert find(wanted, frames) == track


def test_decisions_that_are_not_placed_have_no_effect():
    here, gone, same_track = anchor(1), anchor(9), anchor(2)
    finder = AnchorFinder([here, gone, same_track])
    finder.add("front", 1, seen((7, BOX)))
    finder.add("front", 2, seen((7, BOX)))
    decisions = Decisions(same=((here, gone), (here, same_track)), different=((here, same_track),))
    assert Constraints.of(decisions, finder) == Constraints()


def test_an_anchor_needs_as_many_boxes_as_frames():
    with pytest.raises(ValueError, match="2 frames and 1 boxes"):
        TrackAnchor("front", (1, 2), (BOX,))


def test_of_what_is_said_both_ways_nothing_is_known():
    """A person cut track 7 after frame 1 and said of its parts that one is 8, the other not; here it is whole."""
    before, after, beside = anchor(1), anchor(2), TrackAnchor("front", (1,), (BESIDE,))
    finder = AnchorFinder([before, after, beside])
    finder.add("front", 1, seen((7, BOX), (8, BESIDE)))
    finder.add("front", 2, seen((7, BOX)))
    assert Constraints.of(Decisions(same=((before, beside),)), finder) == Constraints(same=((7, 8),))
    decisions = Decisions(same=((before, beside),), different=((after, beside),))
    assert Constraints.of(decisions, finder) == Constraints()
