"""The first pass over the observations: which of them may give their label to others (the paper's Algorithm 3).

Kept of each identity are its best observations, as many as have a say in a label. Where donors have to be near in time,
time is cut into slots of a tenth of the window, and the best of each slot are kept; a donor then comes from the same
slot or one of the nine on either side. So it is always less than the window away, none that is nearer than nine tenths
of it is overlooked, and memory grows with the time that identities are seen for, not with the number of observations.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from labeler.propagation.config import PropagationConfig
from labeler.propagation.errors import PropagationError
from labeler.propagation.types import Donor, Votes
from labeler.tracking.types import Observations

SLOTS_PER_WINDOW = 10
SCORE_DIGITS = 6
"""Scores count to a millionth, as stores keep them: then what is read back gives the same labels again."""

_ANY_TIME = 0
_NS_PER_S = 1e9


def collect_votes(
    batches: Iterable[tuple[str, Observations]],
    identity_of: Mapping[int, int],
    *,
    config: PropagationConfig | None = None,
    timestamp_ns: NDArray[np.int64] | None = None,
) -> dict[int, Votes]:
    """The votes of each identity, by identity id.

    ``batches`` are observations with the name of their camera, cut and ordered in any way; ``identity_of`` maps track
    ids to identity ids; a track that it doesn't name is an identity of its own, with the track's id. ``timestamp_ns``
    (F,) is the time of each frame; PropagationError where the config needs it and it is not given. Observations without
    a score (NaN) donate nothing, so an identity may be without a donor.
    """
    config = config or PropagationConfig()
    kept: dict[int, _Kept] = {}
    for camera, exact in batches:
        observations = with_plain_scores(exact)
        identity = identities_of(observations.track_id, identity_of)
        for identity_id, count in zip(*_counts(identity), strict=True):
            kept.setdefault(identity_id, _Kept()).observation_count += count
        with np.errstate(invalid="ignore"):
            scored = np.isfinite(observations.score)
            able = scored & (observations.score >= config.min_donor_score)
        _add_scores(kept, camera, identity[scored], observations[scored])
        slot = slots_of(observations.frame_index[able], config, timestamp_ns)
        for identity_id, slot_of_donor, donor in _best_rows(camera, identity[able], slot, observations[able], config):
            kept[identity_id].add(slot_of_donor, donor, config.voters)
    return {identity_id: one.votes() for identity_id, one in kept.items()}


def elect(candidates: Iterable[Donor], config: PropagationConfig) -> Donor | None:
    """The donor among observations that may be one; None where there are none.

    Better is a higher score, then an earlier frame, then a smaller track id. With top-k, the best ``top_k`` vote by
    their scores, and the class with the most wins; of equals the one that has the better observation.
    """
    voters = sorted(candidates, key=rank)[: config.voters]
    if not voters:
        return None
    votes: dict[int, float] = {}
    for voter in voters:
        votes[voter.class_id] = votes.get(voter.class_id, 0.0) + voter.score
    winner = max(votes, key=lambda class_id: votes[class_id])  # of equals the first: classes stand in order of rank
    return next(voter for voter in voters if voter.class_id == winner)


def donor_of(votes: Votes, config: PropagationConfig) -> Donor | None:
    """The donor of an identity as a whole, whatever its time."""
    return elect((donor for of_slot in votes.best.values() for donor in of_slot), config)


def donor_near(votes: Votes, slot: int, config: PropagationConfig) -> Donor | None:
    """The donor for the observations of a slot of time."""
    if config.window_s == 0:
        return elect(votes.best.get(_ANY_TIME, ()), config)
    near = range(slot - SLOTS_PER_WINDOW + 1, slot + SLOTS_PER_WINDOW)
    return elect((donor for one in near for donor in votes.best.get(one, ())), config)


def slots_of(
    frame_index: NDArray[np.int32], config: PropagationConfig, timestamp_ns: NDArray[np.int64] | None
) -> NDArray[np.int64]:
    """(N,) the slot of time of each row; one for all where donors may come from any time."""
    if config.window_s == 0:
        return np.full(len(frame_index), _ANY_TIME, np.int64)
    if timestamp_ns is None:
        raise PropagationError("Donors within a time window need the times of the frames, and none are given.")
    since_ns = timestamp_ns[frame_index] - timestamp_ns[0]
    return np.floor(since_ns / (config.window_s / SLOTS_PER_WINDOW * _NS_PER_S)).astype(np.int64)


def identities_of(track_id: NDArray[np.int32], identity_of: Mapping[int, int]) -> NDArray[np.int32]:
    """(N,) int32 identity of each row; the mapping is asked once per track, not once per row."""
    tracks, inverse = np.unique(track_id, return_inverse=True)
    return np.array([identity_of.get(track, track) for track in tracks.tolist()], np.int32)[inverse]


def with_plain_scores(observations: Observations) -> Observations:
    """The observations with their scores to a millionth."""
    score = np.round(observations.score.astype(np.float64), SCORE_DIGITS).astype(np.float32)
    return replace(observations, score=score)


def rank(donor: Donor) -> tuple[float, int, int]:
    """The smaller the better."""
    return (-donor.score, donor.frame_index, donor.track_id)


@dataclass(eq=False)
class _Kept:
    """The votes of one identity while they come in."""

    best: dict[int, list[Donor]] = field(default_factory=dict[int, list[Donor]])
    observation_count: int = 0
    score_sums: dict[str, dict[int, float]] = field(default_factory=dict[str, dict[int, float]])

    def add(self, slot: int, donor: Donor, voters: int) -> None:
        self.best[slot] = sorted([*self.best.get(slot, []), donor], key=rank)[:voters]

    def votes(self) -> Votes:
        best = {slot: tuple(of_slot) for slot, of_slot in sorted(self.best.items())}
        return Votes(best, self.observation_count, self.score_sums)


def _counts(identity: NDArray[np.int32]) -> tuple[list[int], list[int]]:
    """Each identity once, and how many rows it has."""
    found, count = np.unique(identity, return_counts=True)
    return found.tolist(), count.tolist()


def _add_scores(
    kept: Mapping[int, _Kept], camera: str, identity: NDArray[np.int32], observations: Observations
) -> None:
    """Add the scores of observations, which all have one, to the sums of their identities by class."""
    pairs, inverse = np.unique(np.stack([identity, observations.class_id], axis=1), axis=0, return_inverse=True)
    sums = np.bincount(inverse.ravel(), weights=observations.score, minlength=len(pairs))
    for (identity_id, class_id), score in zip(pairs.tolist(), sums.tolist(), strict=True):
        of_camera = kept[identity_id].score_sums.setdefault(camera, {})
        of_camera[class_id] = of_camera.get(class_id, 0.0) + score


def _best_rows(
    camera: str,
    identity: NDArray[np.int32],
    slot: NDArray[np.int64],
    able: Observations,
    config: PropagationConfig,
) -> Iterator[tuple[int, int, Donor]]:
    """(identity, slot, donor) for the best rows of each identity and slot, as many as may have a say."""
    order = np.lexsort((able.track_id, able.frame_index, -able.score, slot, identity))
    groups = np.stack([identity[order], slot[order]], axis=1)
    starts = np.flatnonzero((np.diff(groups, axis=0, prepend=groups[:1] - 1) != 0).any(axis=1))
    place = np.arange(len(order)) - np.repeat(starts, np.diff(np.append(starts, len(order))))
    for row in order[place < config.voters].tolist():
        donor = Donor(
            track_id=int(able.track_id[row]),
            camera=camera,
            frame_index=int(able.frame_index[row]),
            class_id=int(able.class_id[row]),
            score=float(able.score[row]),
        )
        yield int(identity[row]), int(slot[row]), donor
