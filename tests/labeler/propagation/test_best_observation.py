"""Donors and labels, worked out by hand."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labeler.propagation import Donor, PropagationConfig, find_donors, label_observations
from labeler.tracking import Observations

Row = tuple[int, int, float, int]  # track, frame, score, class
CAR, TRUCK = 2, 7


def observations(rows: Sequence[Row]) -> Observations:
    table = np.array(rows, np.float64).reshape(-1, 4)
    return Observations(
        track_id=table[:, 0].astype(np.int32),
        frame_index=table[:, 1].astype(np.int32),
        xyxy_px=np.zeros((len(table), 4), np.float32),
        score=table[:, 2].astype(np.float32),
        class_id=table[:, 3].astype(np.int16),
        detection_index=np.arange(len(table), dtype=np.int32),
    )


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        ([(1, 0, 0.5, CAR), (1, 1, 0.75, TRUCK)], (1, 1, TRUCK, 0.75)),  # the highest score
        ([(2, 0, 0.5, CAR), (1, 1, 0.75, CAR)], (1, 1, CAR, 0.75)),  # the other track of the identity is better
        ([(1, 5, 0.5, CAR), (1, 3, 0.5, TRUCK)], (1, 3, TRUCK, 0.5)),  # equal: the earliest frame
        ([(2, 3, 0.5, CAR), (1, 3, 0.5, TRUCK)], (1, 3, TRUCK, 0.5)),  # equal again: the smallest track
        ([(1, 0, np.nan, CAR), (1, 1, 0.25, TRUCK)], (1, 1, TRUCK, 0.25)),  # no score donates nothing
        ([(1, 0, 0.0, CAR)], (1, 0, CAR, 0.0)),  # a score of zero is a score
    ],
)
def test_donor(rows: list[Row], expected: tuple[int, int, int, float]) -> None:
    track_id, frame_index, class_id, score = expected
    donor = Donor(track_id=track_id, camera="front", frame_index=frame_index, class_id=class_id, score=score)
    both_one = {1: 1, 2: 1}
    assert find_donors([("front", observations(rows))], both_one) == {1: donor}
    row_by_row = [("front", observations([row])) for row in reversed(rows)]
    assert find_donors(row_by_row, both_one) == {1: donor}


def test_donor_in_another_camera_names_it() -> None:
    batches = [("front", observations([(1, 0, 0.5, CAR)])), ("left", observations([(4, 2, 0.75, CAR)]))]
    assert find_donors(batches, {1: 1, 4: 1}) == {1: Donor(4, "left", 2, CAR, 0.75)}


def test_no_score_at_all_is_no_donor() -> None:
    assert find_donors([("front", observations([(1, 0, np.nan, CAR)]))], {}) == {}
    assert find_donors([("front", Observations.empty())], {}) == {}
    assert find_donors([], {}) == {}


def test_a_score_below_the_least_donates_nothing() -> None:
    batch = [("front", observations([(1, 0, 0.25, CAR), (2, 0, 0.5, CAR)]))]
    assert set(find_donors(batch, {}, config=PropagationConfig(min_donor_score=0.5))) == {2}


def test_labels_and_their_lineage() -> None:
    """Tracks 3 and 5 are identity 3, whose best is track 5 in frame 8; track 9 is alone; track 11 has no score."""
    batch = observations(
        [
            (3, 7, 0.25, CAR),
            (5, 7, 0.5, CAR),
            (5, 8, 0.75, TRUCK),
            (9, 8, 0.5, CAR),
            (3, 8, np.nan, CAR),
            (11, 8, np.nan, CAR),
        ]
    )
    identity_of = {3: 3, 5: 3}
    labels = label_observations(batch, identity_of, find_donors([("front", batch)], identity_of))

    assert labels.track_id.tolist() == [3, 5, 5, 9, 3, 11]
    assert labels.frame_index.tolist() == [7, 7, 8, 8, 8, 8]
    assert labels.identity_id.tolist() == [3, 3, 3, 9, 3, 11]
    assert labels.class_id.tolist() == [TRUCK, TRUCK, TRUCK, CAR, TRUCK, CAR]
    np.testing.assert_array_equal(labels.score, np.array([0.75, 0.75, 0.75, 0.5, 0.75, np.nan], np.float32))
    assert labels.donor_track_id.tolist() == [5, 5, 5, 9, 5, 11]
    assert labels.donor_frame_index.tolist() == [8, 8, 8, 8, 8, 8]
    assert labels.propagated.tolist() == [True, True, False, False, True, False]
    dtypes = [labels.identity_id.dtype, labels.class_id.dtype, labels.score.dtype, labels.donor_track_id.dtype]
    assert dtypes == [np.int32, np.int16, np.float32, np.int32]


def test_nothing_to_label() -> None:
    labels = label_observations(Observations.empty(), {}, {})
    assert len(labels) == 0
    assert labels.propagated.dtype == np.bool_


row = st.tuples(st.integers(0, 4), st.integers(0, 4), st.sampled_from([0.25, 0.5, 0.75, np.nan]), st.integers(0, 3))


@settings(deadline=None)
@given(
    st.lists(row, max_size=20, unique_by=lambda r: (r[0], r[1])),
    st.dictionaries(st.integers(0, 4), st.integers(0, 4)),
    st.integers(1, 7),
)
def test_batches_of_any_size_give_the_same(rows: list[Row], identity_of: dict[int, int], batch_size: int) -> None:
    whole = observations(rows)
    donors = find_donors([("front", whole)], identity_of)
    cut = [whole[start : start + batch_size] for start in range(0, len(whole), batch_size)]
    assert find_donors((("front", batch) for batch in reversed(cut)), identity_of) == donors

    labels = label_observations(whole, identity_of, donors)
    pieces = [label_observations(batch, identity_of, donors) for batch in cut]
    for name in ("identity_id", "class_id", "score", "donor_track_id", "donor_frame_index", "propagated"):
        joined = [value for piece in pieces for value in getattr(piece, name).tolist()]
        np.testing.assert_array_equal(getattr(labels, name), joined)

    for index, (track, _, score, class_id) in enumerate(rows):  # Algorithm 3, row by row
        of_identity = [r for r in rows if identity_of.get(r[0], r[0]) == identity_of.get(track, track)]
        best = min((r for r in of_identity if r[2] == r[2]), key=lambda r: (-r[2], r[1], r[0]), default=None)
        expected = (class_id, score) if best is None else (best[3], best[2])
        np.testing.assert_array_equal((labels.class_id[index], labels.score[index]), expected)
