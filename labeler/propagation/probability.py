"""How likely a label is right: its class is that of a true object that its box overlaps by an IoU of at least .5.

The paper's confidence is the donor's score, and says nothing of the box that takes it over. This is a logistic model of
what is known when a label is given. Its log odds are a sum of one curve for each feature, piecewise linear; they were
fitted on simulated and on real drives with truth (``python -m labeler.evaluation.calibrate_labels``, which also says
how well they hold on others) and lie in ``probability.json`` beside this module.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from importlib import resources

import numpy as np
from numpy.typing import NDArray

from labeler.tracking.curves import CurveModel
from labeler.tracking.types import NO_DETECTION, Observations

_Array = NDArray[np.float64]

FILE_NAME = "probability.json"
FEATURES = (
    "donor_score",
    "own_score",
    "filled",
    "other_class",
    "trust",
    "donor_s",
    "height",
    "observations",
    "class_share",
    "cameras",
)
"""In order: the label's score; the observation's own score, 0 where it is filled in; 1 where it is filled in; 1 where
its own class is another; how far its box is trusted (:mod:`labeler.tracking.trust`); seconds to the donor, as log of 1
plus; log of the box's height in pixels; log of how many observations the identity has; the share of their scores that
is for the label's class; in how many cameras that class wins."""

PIXEL_DIGITS = 2
"""Boxes count to a hundredth of a pixel, as stores keep them: what is read back is then as likely as before."""

_LEAST_HEIGHT_PX = 1.0


@dataclass(frozen=True, eq=False)
class LabelFacts:
    """What the features are made of, a row for each label: its observation, ``class_id`` (N,) and ``score`` (N,) of the
    label, ``donor_s`` (N,) seconds to the donor, and of the identity ``observation_count``, ``class_share`` and
    ``cameras`` (N,)."""

    observations: Observations
    class_id: NDArray[np.int16]
    score: NDArray[np.float32]
    donor_s: _Array
    observation_count: _Array
    class_share: _Array
    cameras: _Array


def features_of(facts: LabelFacts) -> _Array:
    """(N, F) the FEATURES of each label."""
    observations = facts.observations
    filled = observations.detection_index == NO_DETECTION
    top_px, bottom_px = np.round(observations.xyxy_px[:, [1, 3]].astype(np.float64), PIXEL_DIGITS).T
    columns = (
        np.nan_to_num(facts.score),
        np.nan_to_num(observations.score),
        filled,
        ~filled & (observations.class_id != facts.class_id),
        observations.trust,
        np.log1p(facts.donor_s),
        np.log(np.maximum(bottom_px - top_px, _LEAST_HEIGHT_PX)),
        np.log(np.maximum(facts.observation_count, 1.0)),
        facts.class_share,
        facts.cameras,
    )
    return np.stack([column.astype(np.float64) for column in columns], axis=1)


def probability_of(features: _Array, model: CurveModel | None = None) -> _Array:
    """(N,) probability for each row of FEATURES (N, F), by the model that ships unless another is given."""
    return (model or shipped()).probability(features, FEATURES)


@cache
def shipped() -> CurveModel:
    """The model that lies beside this module."""
    return CurveModel.from_json(json.loads(shipped_text()))


def shipped_text() -> str:
    """Its content: what depends on the model is keyed by it."""
    return (resources.files("labeler.propagation") / FILE_NAME).read_text(encoding="utf-8")
