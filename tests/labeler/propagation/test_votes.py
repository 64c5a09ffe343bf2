"""Donors, worked out by hand."""

import numpy as np
import pytest

from labeler.propagation import Donor, PropagationConfig, PropagationError, Votes, collect_votes, donor_of
from labeler.propagation.votes import donor_near
from labeler.tracking import Observations
from tests.labeler.propagation.rows import CAR, TRUCK, Row, observations

TEN_HZ_NS = 5_000_000_000 + 100_000_000 * np.arange(100, dtype=np.int64)


def donors(votes: dict[int, Votes], config: PropagationConfig | None = None) -> dict[int, Donor]:
    found = {identity: donor_of(one, config or PropagationConfig()) for identity, one in votes.items()}
    return {identity: donor for identity, donor in found.items() if donor is not None}


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
    assert donors(collect_votes([("front", observations(rows))], both_one)) == {1: donor}
    row_by_row = [("front", observations([row])) for row in reversed(rows)]
    assert donors(collect_votes(row_by_row, both_one)) == {1: donor}


def test_donor_in_another_camera_names_it() -> None:
    batches = [("front", observations([(1, 0, 0.5, CAR)])), ("left", observations([(4, 2, 0.75, CAR)]))]
    assert donors(collect_votes(batches, {1: 1, 4: 1})) == {1: Donor(4, "left", 2, CAR, 0.75)}


def test_no_score_at_all_is_no_donor() -> None:
    votes = collect_votes([("front", observations([(1, 0, np.nan, CAR)]))], {})
    assert votes == {1: Votes({}, 1, {})}
    assert donors(votes) == {}
    assert collect_votes([("front", Observations.empty())], {}) == {}
    assert collect_votes([], {}) == {}


def test_a_score_below_the_least_donates_nothing() -> None:
    config = PropagationConfig(min_donor_score=0.5)
    batch = [("front", observations([(1, 0, 0.25, CAR), (2, 0, 0.5, CAR)]))]
    assert set(donors(collect_votes(batch, {}, config=config), config)) == {2}


def test_only_the_best_are_kept() -> None:
    """Of 90 observations in three batches, one with `highest`, three with `top-k` of three."""
    batches = [
        ("front", observations([(1, frame, frame / 128, CAR) for frame in range(start, start + 30)]))
        for start in (0, 30, 60)
    ]
    assert [len(best) for best in collect_votes(batches, {})[1].best.values()] == [1]
    kept = collect_votes(batches, {}, config=PropagationConfig(rule="top-k", top_k=3))[1]
    assert [donor.frame_index for best in kept.best.values() for donor in best] == [89, 88, 87]
    assert kept.observation_count == 90


@pytest.mark.parametrize(
    ("rows", "top_k", "expected"),
    [
        # .5 + .375 for the truck beat .75 for the car; the truck's better one is the donor
        ([(1, 0, 0.75, CAR), (1, 1, 0.5, TRUCK), (1, 2, 0.375, TRUCK)], 3, (1, TRUCK, 0.5)),
        # with two voters .75 beats .5
        ([(1, 0, 0.75, CAR), (1, 1, 0.5, TRUCK), (1, 2, 0.375, TRUCK)], 2, (0, CAR, 0.75)),
        # one voter is the paper's rule
        ([(1, 0, 0.5, CAR), (1, 1, 0.75, TRUCK), (1, 2, 0.5, CAR)], 1, (1, TRUCK, 0.75)),
        # .5 + .25 equal .75: the class of the better observation wins
        ([(1, 0, 0.5, TRUCK), (1, 1, 0.25, TRUCK), (1, 2, 0.75, CAR)], 3, (2, CAR, 0.75)),
        # more voters than observations
        ([(1, 0, 0.25, CAR)], 5, (0, CAR, 0.25)),
    ],
)
def test_the_best_vote(rows: list[Row], top_k: int, expected: tuple[int, int, float]) -> None:
    config = PropagationConfig(rule="top-k", top_k=top_k)
    for batches in ([observations(rows)], [observations([row]) for row in reversed(rows)]):
        donor = donors(collect_votes([("front", batch) for batch in batches], {}, config=config), config)[1]
        assert (donor.frame_index, donor.class_id, donor.score) == expected


def test_a_window_takes_the_best_that_is_near() -> None:
    """Ten frames a second, a window of 1 s: slots are frames. Frame 0 is best; up to frame 9 it is near enough."""
    config = PropagationConfig(window_s=1.0)
    rows = [(1, frame, {0: 0.9375, 15: 0.75}.get(frame, 0.5), CAR) for frame in range(40)]
    votes = collect_votes([("front", observations(rows))], {}, config=config, timestamp_ns=TEN_HZ_NS)[1]
    chosen = [donor_near(votes, frame, config) for frame in range(40)]
    frames = [-1 if donor is None else donor.frame_index for donor in chosen]
    # frames 10 to 24 are near 15; later ones see equals, of which the earliest is that nine frames before
    assert frames == [0] * 10 + [15] * 15 + [frame - 9 for frame in range(25, 40)]
    whole = donor_of(votes, config)
    assert whole is not None
    assert whole.frame_index == 0


def test_a_window_without_anybody_near_has_no_donor() -> None:
    config = PropagationConfig(window_s=1.0, min_donor_score=0.5)
    batch = [("front", observations([(1, 0, 0.75, CAR), (1, 30, 0.25, CAR)]))]
    votes = collect_votes(batch, {}, config=config, timestamp_ns=TEN_HZ_NS)[1]
    assert donor_near(votes, 30, config) is None


def test_a_window_needs_times() -> None:
    with pytest.raises(PropagationError, match="times of the frames"):
        collect_votes([("front", observations([(1, 0, 0.5, CAR)]))], {}, config=PropagationConfig(window_s=1.0))


def test_shares_of_the_scores() -> None:
    """Front: .5 + .25 for car, .25 for truck. Left: .5 for truck. So car has .75 of 1.5, and wins in front only."""
    votes = collect_votes(
        [
            ("front", observations([(1, 0, 0.5, CAR), (1, 1, 0.25, TRUCK), (1, 2, 0.25, CAR), (1, 3, np.nan, TRUCK)])),
            ("left", observations([(2, 0, 0.5, TRUCK)])),
        ],
        {1: 1, 2: 1},
    )[1]
    assert votes.observation_count == 5
    assert (votes.class_share(CAR), votes.class_share(TRUCK), votes.class_share(99)) == (0.5, 0.5, 0.0)
    assert (votes.cameras_for(CAR), votes.cameras_for(TRUCK), votes.cameras_for(99)) == (1, 1, 0)
