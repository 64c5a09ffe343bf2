"""The second pass over the observations: the label of each, from the donor that the votes of its identity choose."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from labeler.propagation.config import PropagationConfig
from labeler.propagation.probability import LabelFacts, features_of, probability_of
from labeler.propagation.purity import withhold
from labeler.propagation.types import Donor, Labels, Votes, Withheld
from labeler.propagation.votes import donor_near, identities_of, slots_of, with_plain_scores
from labeler.tracking.types import Observations

_Scalar = TypeVar("_Scalar", bound=np.generic)

_NS_PER_S = 1e9
_NOTHING_KNOWN = Votes({}, 0, {})


def label_observations(
    observations: Observations,
    identity_of: Mapping[int, int],
    votes: Mapping[int, Votes],
    *,
    config: PropagationConfig | None = None,
    timestamp_ns: NDArray[np.int64] | None = None,
) -> Labels:
    """The label of each observation, row by row.

    ``identity_of``, ``votes``, ``config`` and ``timestamp_ns`` as in :func:`labeler.propagation.votes.collect_votes`.
    Where there is no donor, or the label is withheld (:mod:`labeler.propagation.purity`), an observation keeps its own
    class and score (NaN where it has none), and names itself as the donor. Without ``timestamp_ns`` the labels have no
    probability.
    """
    labels = _labels_of(observations, identity_of, votes, config or PropagationConfig(), timestamp_ns)
    if timestamp_ns is None:
        return labels
    probability = probability_of(label_features(observations, labels, votes, timestamp_ns))
    known = np.where(np.isnan(labels.score), np.nan, probability)
    return replace(labels, probability=known.astype(np.float32))


def label_features(
    observations: Observations, labels: Labels, votes: Mapping[int, Votes], timestamp_ns: NDArray[np.int64]
) -> NDArray[np.float64]:
    """(N, F) what the probability of labels is made from, see :mod:`labeler.propagation.probability`."""
    off_ns = np.abs(timestamp_ns[labels.donor_frame_index] - timestamp_ns[labels.frame_index])
    known = _known_of(labels.identity_id, labels.class_id, votes)
    plain = with_plain_scores(observations)
    return features_of(LabelFacts(plain, labels.class_id, labels.score, off_ns / _NS_PER_S, *known))


def _labels_of(
    observations: Observations,
    identity_of: Mapping[int, int],
    votes: Mapping[int, Votes],
    config: PropagationConfig,
    timestamp_ns: NDArray[np.int64] | None,
) -> Labels:
    """Labels without their probability."""
    observations = with_plain_scores(observations)
    identity = identities_of(observations.track_id, identity_of)
    withheld = withhold(observations, config)
    given = _Given.of(identity, slots_of(observations.frame_index, config, timestamp_ns), votes, config)
    takes = given.has_donor & (withheld == Withheld.NO)

    def filled(own: NDArray[_Scalar], of_donor: NDArray[_Scalar]) -> NDArray[_Scalar]:
        return np.where(takes, of_donor, own)

    donor_track_id = filled(observations.track_id, given.track_id)
    donor_frame_index = filled(observations.frame_index, given.frame_index)
    own = (donor_track_id == observations.track_id) & (donor_frame_index == observations.frame_index)
    return Labels(
        track_id=observations.track_id,
        frame_index=observations.frame_index,
        identity_id=identity,
        class_id=filled(observations.class_id, given.class_id),
        score=filled(observations.score, given.score),
        donor_track_id=donor_track_id,
        donor_frame_index=donor_frame_index,
        propagated=~own,
        withheld=withheld,
    )


@dataclass(frozen=True, eq=False)
class _Given:
    """The donor of each row (N,), and whether there is one."""

    has_donor: NDArray[np.bool_]
    track_id: NDArray[np.int32]
    frame_index: NDArray[np.int32]
    class_id: NDArray[np.int16]
    score: NDArray[np.float32]

    @staticmethod
    def of(
        identity: NDArray[np.int32], slot: NDArray[np.int64], votes: Mapping[int, Votes], config: PropagationConfig
    ) -> _Given:
        """Donors are asked for once for each identity and slot of time."""
        places, inverse = np.unique(np.stack([identity, slot], axis=1), axis=0, return_inverse=True)
        nobody = Donor(0, "", 0, 0, 0.0)
        found = [donor_near(votes.get(one, _NOTHING_KNOWN), at, config) for one, at in places.tolist()]
        donors = [donor or nobody for donor in found]
        row = inverse.ravel()
        return _Given(
            np.array([donor is not None for donor in found], np.bool_)[row],
            np.array([donor.track_id for donor in donors], np.int32)[row],
            np.array([donor.frame_index for donor in donors], np.int32)[row],
            np.array([donor.class_id for donor in donors], np.int16)[row],
            np.array([donor.score for donor in donors], np.float32)[row],
        )


def _known_of(
    identity: NDArray[np.int32], class_id: NDArray[np.int16], votes: Mapping[int, Votes]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """(N,) how many observations the identity of each row has, which share of their scores is for the row's class, and
    in how many cameras that class wins."""
    places, inverse = np.unique(np.stack([identity, class_id], axis=1), axis=0, return_inverse=True)
    known = [(votes.get(one, _NOTHING_KNOWN), of_class) for one, of_class in places.tolist()]
    table = [(one.observation_count, one.class_share(of_class), one.cameras_for(of_class)) for one, of_class in known]
    of_row = np.array(table, np.float64).reshape(-1, 3)[inverse.ravel()]
    return of_row[:, 0], of_row[:, 1], of_row[:, 2]
