"""Observations that must not take their identity's label: their box probably shows something else.

A track mixes objects where one hides another, and a detector's box may hold a sliver of the object or nothing at all.
The tracker knows how each box fits into its track and says how far it trusts it (:mod:`labeler.tracking.trust`); what
it trusts too little keeps the detector's own label.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from labeler.propagation.config import PropagationConfig
from labeler.propagation.types import Withheld
from labeler.tracking.types import Observations


def withhold(observations: Observations, config: PropagationConfig) -> NDArray[np.uint8]:
    """(N,) uint8, a :class:`Withheld` for each observation."""
    doubtful = observations.trust < config.min_trust
    return np.where(doubtful, Withheld.DOUBTFUL_BOX, Withheld.NO).astype(np.uint8)
