"""Labels of the labeler as the store keeps them."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from labeler.propagation.types import Labels, LabelSource, Withheld
from labeler.propagation.votes import SCORE_DIGITS

PROBABILITY_DIGITS = 4

WITHHELD = {Withheld.NO: None} | {reason: reason.name.lower() for reason in Withheld if reason is not Withheld.NO}
"""What the store calls each reason."""


def label_values(labels: Labels) -> dict[str, Sequence[Any]]:
    """The columns of labels, but for what names their observations."""
    sources = (LabelSource.AUTO.value, LabelSource.PROPAGATED.value)
    return {
        "class_id": labels.class_id.tolist(),
        "score": scores_of(labels.score),
        "source": [sources[given] for given in labels.propagated.tolist()],
        "donor_track_id": labels.donor_track_id.tolist(),
        "donor_frame_index": labels.donor_frame_index.tolist(),
        "withheld": [WITHHELD[Withheld(reason)] for reason in labels.withheld.tolist()],
        "probability": scores_of(labels.probability, digits=PROBABILITY_DIGITS),
    }


def scores_of(scores: NDArray[np.float32], *, digits: int = SCORE_DIGITS) -> list[float | None]:
    """Scores in double precision, rounded; None where there is none."""
    rounded: list[float] = np.round(scores.astype(np.float64), digits).tolist()
    return [None if math.isnan(score) else score for score in rounded]
