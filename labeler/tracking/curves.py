"""Probabilities from features: log odds that are a sum of one curve for each, piecewise linear between knots.

A logistic regression that may bend. :mod:`labeler.evaluation.curve_fitting` fits one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

_Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CurveModel:
    """Curves by the name of their feature, as (knots, log odds), and what is added to all."""

    bias: float
    curves: Mapping[str, tuple[_Array, _Array]]

    def probability(self, features: _Array, names: Sequence[str]) -> _Array:
        """(N,) for each row of features (N, F), of these names; a curve goes on level beyond its knots."""
        total = np.full(len(features), self.bias)
        for column, name in enumerate(names):
            knots, log_odds = self.curves[name]
            total += np.interp(features[:, column], knots, log_odds)
        return 1 / (1 + np.exp(-total))

    @staticmethod
    def from_json(content: Mapping[str, Any]) -> CurveModel:
        """What :meth:`to_json` gives."""
        curves = {
            name: (np.array(curve["knots"], np.float64), np.array(curve["log_odds"], np.float64))
            for name, curve in content["curves"].items()
        }
        return CurveModel(float(content["bias"]), curves)

    def to_json(self) -> dict[str, Any]:
        """Plain values, rounded."""
        curves = {
            name: {"knots": knots.round(4).tolist(), "log_odds": log_odds.round(4).tolist()}
            for name, (knots, log_odds) in self.curves.items()
        }
        return {"bias": round(self.bias, 4), "curves": curves}
