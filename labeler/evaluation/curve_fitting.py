"""Fits a :class:`labeler.tracking.curves.CurveModel`: the curves that make what came true most probable.

A curve may be held to the direction that sense demands, so that it holds beyond what was seen, and a ridge keeps it
straight where nothing speaks for a bend.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import expit

from labeler.tracking.curves import CurveModel

Direction = tuple[float | None, float | None]
"""Bounds of a curve's steps from knot to knot."""

FALLS: Direction = (None, 0.0)
RISES: Direction = (0.0, None)

_Array = NDArray[np.float64]
_MAX_KNOTS = 6
_RIDGE = 2.0
_LEVEL_RIDGE = 0.1


def fit_curves(
    features: _Array,
    is_right: _Array,
    weight: _Array,
    *,
    names: Sequence[str],
    flags: Collection[str] = (),
    directions: Mapping[str, Direction] | None = None,
) -> CurveModel:
    """Curves of the features (N, F) called ``names`` for what came true (N,), from 0 to 1, of each row, weighed (N,).

    ``flags`` are features that are 0 or 1. The mean weight is taken as 1."""
    directions = directions or {}
    weight = weight * len(weight) / weight.sum()
    knots = [_knots(features[:, column], is_flag=name in flags) for column, name in enumerate(names)]
    # A curve is its level at the first knot and steps from knot to knot: a direction is a bound on the steps.
    steps = [_hats(features[:, column], at) @ np.tri(len(at)) for column, at in enumerate(knots)]
    matrix = np.concatenate([np.ones((len(features), 1)), *steps], axis=1)
    smooth = _bend_penalty(knots)
    bounds: list[Direction] = [(None, None)]
    for name, at in zip(names, knots, strict=True):
        bounds += [(None, None), *[directions.get(name, (None, None))] * (len(at) - 1)]

    def loss(weights: _Array) -> tuple[float, _Array]:
        z = matrix @ weights
        held = smooth @ weights
        value = float(weight @ (np.logaddexp(0, z) - is_right * z) + weights @ held / 2)
        return value, matrix.T @ (weight * (expit(z) - is_right)) + held

    start = np.zeros(matrix.shape[1])
    found = minimize(loss, start, jac=True, method="L-BFGS-B", bounds=bounds, options={"maxiter": 500})
    weights = np.asarray(found.x, np.float64)
    bias, at = float(weights[0]), 1
    curves: dict[str, tuple[_Array, _Array]] = {}
    for column, (name, of_curve) in enumerate(zip(names, knots, strict=True)):
        log_odds = np.cumsum(weights[at : at + len(of_curve)])
        at += len(of_curve)
        middle = float(np.interp(np.median(features[:, column]), of_curve, log_odds))  # a middle belongs to the bias
        curves[name] = (of_curve, log_odds - middle)
        bias += middle
    return CurveModel(bias, curves)


def _knots(values: _Array, *, is_flag: bool) -> _Array:
    """Where a curve may bend: at even shares of the rows; where most are equal, in even steps."""
    if is_flag:
        return np.array([0.0, 1.0])
    knots = np.unique(np.round(np.quantile(values, np.linspace(0.01, 0.99, _MAX_KNOTS)), 3))
    if len(knots) < _MAX_KNOTS // 2:
        knots = np.unique(np.round(np.linspace(float(values.min()), float(values.max()), _MAX_KNOTS // 2), 3))
    return knots if len(knots) > 1 else np.array([knots[0], knots[0] + 1.0])


def _hats(values: _Array, knots: _Array) -> _Array:
    """(N, K) how much of a value's curve comes from each knot."""
    return np.stack([np.interp(values, knots, row) for row in np.eye(len(knots))], axis=1)


def _bend_penalty(knots: Sequence[_Array]) -> _Array:
    """The ridge, on levels and steps: a little on the curve's values, more on the differences between its steps."""
    size = 1 + sum(len(one) for one in knots)
    penalty = np.zeros((size, size))
    at = 1
    for one in knots:
        here = slice(at, at + len(one))
        curve = np.tri(len(one))
        bends = np.diff(curve, n=2, axis=0)
        penalty[here, here] = _LEVEL_RIDGE * curve.T @ curve + _RIDGE * bends.T @ bends
        at += len(one)
    return penalty
