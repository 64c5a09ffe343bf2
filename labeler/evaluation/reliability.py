"""How well a probability holds: of labels that are said to be right in seven cases of ten, seven in ten should be."""

from __future__ import annotations

from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

STEPS = 10


class ReliabilityBin(TypedDict):
    """Labels whose probability is at least ``start`` and below ``stop`` (the last with its end): how many, their mean
    probability, and the share of them that is right; None where there are none."""

    start: float
    stop: float
    labels: int
    predicted: float | None
    observed: float | None


class Reliability(TypedDict):
    """``expected_error`` is the expected calibration error: the mean distance between predicted and observed, each step
    weighted by its labels; None without labels."""

    labels: int
    expected_error: float | None
    bins: list[ReliabilityBin]


class ReliabilityCounts:
    """Counts in even steps of probability: :meth:`add` labels part by part, then ask."""

    def __init__(self) -> None:
        self._labels = np.zeros(STEPS, np.int64)
        self._predicted = np.zeros(STEPS)
        self._right = np.zeros(STEPS, np.int64)

    def add(self, probability: NDArray[np.floating], is_right: NDArray[np.bool_]) -> None:
        """Count labels: ``probability`` (N,), NaN where there is none (they are left out), and ``is_right`` (N,)."""
        known = np.isfinite(probability)
        said = probability[known].astype(np.float64)
        step = np.clip((said * STEPS).astype(np.int64), 0, STEPS - 1)
        self._labels += np.bincount(step, minlength=STEPS)
        self._predicted += np.bincount(step, weights=said, minlength=STEPS)
        self._right += np.bincount(step[is_right[known]], minlength=STEPS)

    def reliability(self) -> Reliability:
        total = int(self._labels.sum())
        some = self._labels > 0
        predicted = np.divide(self._predicted, self._labels, out=np.zeros(STEPS), where=some)
        observed = np.divide(self._right, self._labels, out=np.zeros(STEPS), where=some)
        error = float(np.abs(predicted - observed) @ self._labels) / total if total else None
        bins = [
            ReliabilityBin(
                start=step / STEPS,
                stop=(step + 1) / STEPS,
                labels=int(self._labels[step]),
                predicted=round(float(predicted[step]), 4) if some[step] else None,
                observed=round(float(observed[step]), 4) if some[step] else None,
            )
            for step in range(STEPS)
        ]
        return Reliability(labels=total, expected_error=None if error is None else round(error, 4), bins=bins)
