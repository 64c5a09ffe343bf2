"""The probability that two tracks are one object, from what was measured about them.

The log odds are a sum of one curve for each feature, piecewise linear between knots: a logistic regression that may
bend, and still says of each feature what it adds. The curves are fitted on made observations of simulated drives, of
several seeds, rigs, rates and strengths of noise, and on detected ones (``python -m
labeler.evaluation.calibrate_merges``), and lie in ``calibration.json`` beside this module.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import NDArray

from labeler.identity.features import FEATURES
from labeler.identity.types import MergeKind

FILE_NAME = "calibration.json"
MAX_LOG_ODDS = 9.0


@dataclass(frozen=True, eq=False)
class Curve:
    """What a feature adds to the log odds: ``log_odds`` (K,) at ``knots`` (K,) that increase, constant beyond them."""

    knots: NDArray[np.float64]
    log_odds: NDArray[np.float64]

    def __call__(self, value: NDArray[np.float64]) -> NDArray[np.float64]:
        """The same shape as ``value``; 0 where it is NaN."""
        return np.where(np.isnan(value), 0.0, np.interp(value, self.knots, self.log_odds))


@dataclass(frozen=True, eq=False)
class KindModel:
    """The curves of one kind of pairs, in the order of its features, and what is added to all."""

    bias: float
    curves: tuple[Curve, ...]

    def log_odds(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N, K) what each feature (N, K) adds."""
        return np.stack([curve(values[:, column]) for column, curve in enumerate(self.curves)], axis=1)


@dataclass(frozen=True, eq=False)
class Calibration:
    """A model for each kind of pairs."""

    kinds: Mapping[MergeKind, KindModel]

    def log_odds(self, kind: MergeKind, values: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(N,) log odds that the pairs are one object each, and (N, K) what each feature adds to them."""
        model = self.kinds[kind]
        parts = model.log_odds(values)
        return np.clip(model.bias + parts.sum(axis=1), -MAX_LOG_ODDS, MAX_LOG_ODDS), parts

    @staticmethod
    def from_json(value: Mapping[str, Any]) -> Calibration:
        """What :meth:`to_json` gives."""
        kinds: dict[MergeKind, KindModel] = {}
        for kind, names in FEATURES.items():
            of_kind = value[kind.value]
            curves = [of_kind["features"][name] for name, _ in names]
            kinds[kind] = KindModel(
                of_kind["bias"],
                tuple(Curve(np.array(one["knots"], float), np.array(one["log_odds"], float)) for one in curves),
            )
        return Calibration(kinds)

    def to_json(self) -> dict[str, Any]:
        """Plain values, rounded."""
        return {
            kind.value: {
                "bias": round(model.bias, 4),
                "features": {
                    name: {"knots": np.round(curve.knots, 4).tolist(), "log_odds": np.round(curve.log_odds, 4).tolist()}
                    for (name, _), curve in zip(FEATURES[kind], model.curves, strict=True)
                },
            }
            for kind, model in self.kinds.items()
        }


@cache
def shipped_text() -> str:
    """The file that lies beside this module: what the probabilities of merges depend on."""
    return resources.files("labeler.identity").joinpath(FILE_NAME).read_text(encoding="utf-8")


@cache
def shipped_calibration() -> Calibration:
    """The calibration that lies beside this module."""
    return Calibration.from_json(json.loads(shipped_text()))
