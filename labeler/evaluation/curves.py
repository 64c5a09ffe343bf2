"""Precision and recall as the threshold moves, and the average precision."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_RECALLS = np.linspace(0.0, 1.0, 101)


def precision_recall_at(
    score: NDArray[np.float32], is_hit: NDArray[np.bool_], thresholds: NDArray[np.float64], *, truth_count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(K,) precision and (K,) recall of the labels with a score of at least each of (K,) thresholds.

    Precision is 1 where no label is left, recall 0 where there is no truth."""
    order = np.argsort(score, kind="stable")
    ascending = score[order]
    hits_from = np.append(np.cumsum(is_hit[order][::-1])[::-1], 0)
    first = np.searchsorted(ascending, thresholds.astype(np.float32), side="left")
    labels = len(score) - first
    hits = hits_from[first]
    precision = np.divide(hits, labels, out=np.ones(len(thresholds)), where=labels > 0)
    recall = hits / truth_count if truth_count else np.zeros(len(thresholds))
    return precision, recall


def average_precision(score: NDArray[np.float32], is_hit: NDArray[np.bool_], *, truth_count: int) -> float | None:
    """COCO's AP at one IoU: the mean, over 101 recalls, of the best precision at that recall or a higher one.

    ``score`` (M,) and ``is_hit`` (M,) bool of the labels that are hits or false. None where there is no truth.
    """
    if truth_count == 0:
        return None
    order = np.argsort(-score, kind="stable")
    hits = np.cumsum(is_hit[order])
    recall = hits / truth_count
    precision = hits / np.arange(1, len(hits) + 1)
    best_from = np.maximum.accumulate(precision[::-1])[::-1]
    at = np.searchsorted(recall, _RECALLS, side="left")
    return float(np.append(best_from, 0.0)[at].mean())
