"""The paper's step 5: the best observation's label for all observations of its identity (Algorithm 3).

Two passes over the observations, so that a drive of any length streams through: the first keeps one donor per identity,
the second labels each batch from them. Memory grows with the number of identities, not of observations. A track that
the identities don't name is an identity of its own, with the track's id.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from labeler.propagation.config import PropagationConfig
from labeler.propagation.purity import withhold
from labeler.propagation.types import Donor, Labels, Withheld
from labeler.tracking.types import Observations

_Scalar = TypeVar("_Scalar", bound=np.generic)


def find_donors(
    batches: Iterable[tuple[str, Observations]],
    identity_of: Mapping[int, int],
    *,
    config: PropagationConfig | None = None,
) -> dict[int, Donor]:
    """First pass: the donor of each identity, by identity id.

    ``batches`` are observations with the name of their camera, cut and ordered in any way; ``identity_of`` maps track
    ids to identity ids. The donor is the observation with the highest score; of equals the earliest frame, then the
    smallest track id. Observations without a score (NaN) donate nothing, so an identity may be without a donor.
    """
    min_score = (config or PropagationConfig()).min_donor_score
    donors: dict[int, Donor] = {}
    for camera, observations in batches:
        with np.errstate(invalid="ignore"):
            scored = observations[np.isfinite(observations.score) & (observations.score >= min_score)]
        identity = _identities(scored.track_id, identity_of)
        order = np.lexsort((scored.track_id, scored.frame_index, -scored.score, identity))
        found, best = np.unique(identity[order], return_index=True)
        for identity_id, row in zip(found.tolist(), order[best].tolist(), strict=True):
            candidate = Donor(
                track_id=int(scored.track_id[row]),
                camera=camera,
                frame_index=int(scored.frame_index[row]),
                class_id=int(scored.class_id[row]),
                score=float(scored.score[row]),
            )
            current = donors.get(identity_id)
            if current is None or _rank(candidate) < _rank(current):
                donors[identity_id] = candidate
    return donors


def label_observations(
    observations: Observations,
    identity_of: Mapping[int, int],
    donors: Mapping[int, Donor],
    *,
    config: PropagationConfig | None = None,
) -> Labels:
    """Second pass: the label of each observation, row by row, from the donor of its identity.

    ``identity_of`` and ``donors`` as in :func:`find_donors`. Where the identity has no donor, or the label is withheld
    from it (:mod:`labeler.propagation.purity`), an observation keeps its own class and score (NaN where it has none),
    and names itself as the donor.
    """
    withheld = withhold(observations, config or PropagationConfig())
    identity = _identities(observations.track_id, identity_of)
    found, inverse = np.unique(identity, return_inverse=True)
    given = [donors.get(identity_id) for identity_id in found.tolist()]
    has_donor = np.array([donor is not None for donor in given], np.bool_)[inverse] & (withheld == Withheld.NO)

    def from_donor(own: NDArray[_Scalar], of_donors: list[float]) -> NDArray[_Scalar]:
        filled = own.copy()
        filled[has_donor] = np.array(of_donors, own.dtype)[inverse[has_donor]]
        return filled

    donor_track_id = from_donor(observations.track_id, [donor.track_id if donor else 0 for donor in given])
    donor_frame_index = from_donor(observations.frame_index, [donor.frame_index if donor else 0 for donor in given])
    own = (donor_track_id == observations.track_id) & (donor_frame_index == observations.frame_index)
    return Labels(
        track_id=observations.track_id,
        frame_index=observations.frame_index,
        identity_id=identity,
        class_id=from_donor(observations.class_id, [donor.class_id if donor else 0 for donor in given]),
        score=from_donor(observations.score, [donor.score if donor else 0 for donor in given]),
        donor_track_id=donor_track_id,
        donor_frame_index=donor_frame_index,
        propagated=~own,
        withheld=withheld,
    )


def _rank(donor: Donor) -> tuple[float, int, int]:
    return (-donor.score, donor.frame_index, donor.track_id)


def _identities(track_id: NDArray[np.int32], identity_of: Mapping[int, int]) -> NDArray[np.int32]:
    """(N,) int32 identity of each row; the mapping is asked once per track, not once per row."""
    tracks, inverse = np.unique(track_id, return_inverse=True)
    return np.array([identity_of.get(track, track) for track in tracks.tolist()], np.int32)[inverse]
