"""Labels and their lineage, worked out by hand."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from labeler.propagation import PropagationConfig, collect_votes, donor_of, label_observations
from labeler.tracking import Observations
from tests.labeler.propagation.rows import CAR, TRUCK, Row, observations

TEN_HZ_NS = 100_000_000 * np.arange(100, dtype=np.int64)


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
    labels = label_observations(batch, identity_of, collect_votes([("front", batch)], identity_of))

    assert labels.track_id.tolist() == [3, 5, 5, 9, 3, 11]
    assert labels.frame_index.tolist() == [7, 7, 8, 8, 8, 8]
    assert labels.identity_id.tolist() == [3, 3, 3, 9, 3, 11]
    assert labels.class_id.tolist() == [TRUCK, TRUCK, TRUCK, CAR, TRUCK, CAR]
    np.testing.assert_array_equal(labels.score, np.array([0.75, 0.75, 0.75, 0.5, 0.75, np.nan], np.float32))
    assert labels.donor_track_id.tolist() == [5, 5, 5, 9, 5, 11]
    assert labels.donor_frame_index.tolist() == [8, 8, 8, 8, 8, 8]
    assert labels.propagated.tolist() == [True, True, False, False, True, False]
    assert np.isnan(labels.probability).all()  # no times were given
    dtypes = [labels.identity_id.dtype, labels.class_id.dtype, labels.score.dtype, labels.donor_track_id.dtype]
    assert dtypes == [np.int32, np.int16, np.float32, np.int32]


def test_in_a_window_each_takes_the_label_that_is_near() -> None:
    """Two seconds apart, a window of 1 s: a car becomes a truck, and the filled boxes between follow the nearer."""
    config = PropagationConfig(window_s=1.0)
    batch = observations([(1, 0, 0.75, CAR), (1, 4, np.nan, CAR), (1, 16, np.nan, CAR), (1, 20, 0.5, TRUCK)])
    votes = collect_votes([("front", batch)], {}, config=config, timestamp_ns=TEN_HZ_NS)
    labels = label_observations(batch, {}, votes, config=config, timestamp_ns=TEN_HZ_NS)
    assert labels.class_id.tolist() == [CAR, CAR, TRUCK, TRUCK]
    assert labels.donor_frame_index.tolist() == [0, 0, 20, 20]


def test_nothing_to_label() -> None:
    labels = label_observations(Observations.empty(), {}, {}, timestamp_ns=TEN_HZ_NS)
    assert len(labels) == 0
    assert labels.propagated.dtype == np.bool_


row = st.tuples(st.integers(0, 4), st.integers(0, 4), st.sampled_from([0.25, 0.5, 0.75, np.nan]), st.integers(0, 3))
RULES = st.sampled_from(
    [
        PropagationConfig(),
        PropagationConfig(rule="top-k", top_k=2),
        PropagationConfig(window_s=0.2),
        PropagationConfig(rule="top-k", top_k=3, window_s=0.3),
    ]
)


@settings(deadline=None)
@given(
    st.lists(row, max_size=20, unique_by=lambda r: (r[0], r[1])),
    st.dictionaries(st.integers(0, 4), st.integers(0, 4)),
    st.integers(1, 7),
    RULES,
)
def test_batches_of_any_size_give_the_same(
    rows: list[Row], identity_of: dict[int, int], batch_size: int, config: PropagationConfig
) -> None:
    whole = observations(rows)
    votes = collect_votes([("front", whole)], identity_of, config=config, timestamp_ns=TEN_HZ_NS)
    cut = [whole[start : start + batch_size] for start in range(0, len(whole), batch_size)]
    in_pieces = (("front", batch) for batch in reversed(cut))
    assert collect_votes(in_pieces, identity_of, config=config, timestamp_ns=TEN_HZ_NS) == votes

    labels = label_observations(whole, identity_of, votes, config=config, timestamp_ns=TEN_HZ_NS)
    pieces = [label_observations(batch, identity_of, votes, config=config, timestamp_ns=TEN_HZ_NS) for batch in cut]
    names = ("identity_id", "class_id", "score", "donor_track_id", "donor_frame_index", "propagated", "probability")
    for name in names:
        joined = [value for piece in pieces for value in getattr(piece, name).tolist()]
        np.testing.assert_array_equal(getattr(labels, name), joined)


@settings(deadline=None)
@given(
    st.lists(row, max_size=20, unique_by=lambda r: (r[0], r[1])),
    st.dictionaries(st.integers(0, 4), st.integers(0, 4)),
)
def test_the_papers_algorithm_row_by_row(rows: list[Row], identity_of: dict[int, int]) -> None:
    whole = observations(rows)
    labels = label_observations(whole, identity_of, collect_votes([("front", whole)], identity_of))
    for index, (track, _, score, class_id) in enumerate(rows):
        of_identity = [r for r in rows if identity_of.get(r[0], r[0]) == identity_of.get(track, track)]
        best = min((r for r in of_identity if r[2] == r[2]), key=lambda r: (-r[2], r[1], r[0]), default=None)
        expected = (class_id, score) if best is None else (best[3], best[2])
        np.testing.assert_array_equal((labels.class_id[index], labels.score[index]), expected)


def test_a_donor_within_the_window_is_never_farther_than_it() -> None:
    """Uneven times; whatever slots they fall into."""
    random = np.random.default_rng(3)
    times_ns = np.cumsum(random.integers(10_000_000, 400_000_000, 80)).astype(np.int64)
    config = PropagationConfig(window_s=1.3)
    batch = observations([(1, frame, float(random.random()), CAR) for frame in range(80)])
    votes = collect_votes([("front", batch)], {}, config=config, timestamp_ns=times_ns)
    labels = label_observations(batch, {}, votes, config=config, timestamp_ns=times_ns)
    away_s = np.abs(times_ns[labels.donor_frame_index] - times_ns[labels.frame_index]) / 1e9
    assert away_s.max() < 1.3
    for frame in range(80):  # and nobody within nine tenths of it is better
        near = np.abs(times_ns - times_ns[frame]) / 1e9 < 0.9 * 1.3
        assert labels.score[frame] >= batch.score[near].max() - 1e-6
    assert donor_of(votes[1], config) is not None
