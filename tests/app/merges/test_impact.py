"""How many labels a decision about a merge changes."""

from app.merges.impact import Impact
from app.merges.repository import StoredMerge
from app.tracks.repository import TrackFacts


def _track(track_id: int, identity_id: int, *, boxes: int, score: float) -> TrackFacts:
    return TrackFacts(track_id, 1, identity_id, 0, boxes - 1, boxes, score, 0, 0)


def _merge(track_a: int, track_b: int, state: str) -> StoredMerge:
    return StoredMerge(1, track_a, track_b, 0.5, state, "machine", 0, 0, None, None, "", [], {})


def test_the_labels_of_the_lesser_side_change() -> None:
    tracks = [_track(1, 1, boxes=5, score=0.9), _track(2, 1, boxes=3, score=0.4), _track(3, 3, boxes=7, score=0.5)]
    impact = Impact(tracks, [(1, 2)])
    assert impact.label_count(_merge(1, 3, "proposed")) == 7  # 1 has the best box, so all of 3 change
    assert impact.label_count(_merge(1, 2, "accepted")) == 3  # without the merge, 2 loses the label of 1
    assert impact.label_count(_merge(2, 1, "proposed")) == 0  # they are one object already


def test_pairs_that_people_joined_elsewhere_do_not_matter() -> None:
    impact = Impact([_track(1, 1, boxes=5, score=0.9), _track(2, 2, boxes=3, score=0.4)], [(8, 9), (2, 9)])
    assert impact.label_count(_merge(1, 2, "proposed")) == 3
