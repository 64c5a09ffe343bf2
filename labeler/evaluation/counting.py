"""Hits, false labels and misses of one method over a drive.

Each label is judged once for every truth (whole or visible boxes) and IoU, part of the drive by part. Kept are a few
bytes for each label (its score, camera and outcome) and each true object (the score of the label that hits it), from
which the counts at any threshold, the recall of any group of objects, and the curve over all thresholds follow.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from labeler.evaluation.matching import (
    UNMATCHED,
    Pairs,
    fallen_on_dont_care,
    match_greedily,
    rank_labels,
)
from labeler.evaluation.truth import TruthTable

_Scalar = TypeVar("_Scalar", bound=np.generic)

HIT, FALSE_LABEL, ABSORBED = 0, 1, 2

Criterion = tuple[str, float]
"""Which truth ("whole" or "visible"), and the least IoU of a hit."""


@dataclass(frozen=True, eq=False)
class Labels2D:
    """Labels to judge, a row each: ``image`` (N,) int64, ``camera`` (N,) int16, ``xyxy_px`` (N, 4) float32,
    ``label_class`` (N,) int16 as in :mod:`labeler.evaluation.categories`, ``score`` (N,) float32.

    Rows of a class that is not counted, or without a score, are as if they were not there."""

    image: NDArray[np.int64]
    camera: NDArray[np.int16]
    xyxy_px: NDArray[np.float32]
    label_class: NDArray[np.int16]
    score: NDArray[np.float32]

    @property
    def counted(self) -> NDArray[np.bool_]:
        """(N,) whether a row is a label at all."""
        return (self.label_class >= 0) & np.isfinite(self.score)


@dataclass(frozen=True)
class Counts:
    """True positives, false positives and false negatives."""

    tp: int
    fp: int
    fn: int

    @property
    def precision(self) -> float | None:
        """Share of the labels that are right; None without labels."""
        return self.tp / (self.tp + self.fp) if self.tp + self.fp else None

    @property
    def recall(self) -> float | None:
        """Share of the true objects that are found; None without any."""
        return self.tp / (self.tp + self.fn) if self.tp + self.fn else None


@dataclass(frozen=True, eq=False)
class Judgement:
    """``outcome`` (N,) uint8 of each label; ``truth_row`` (N,) intp of the object that it hits, else UNMATCHED.

    Both are meaningless in rows that are no labels."""

    outcome: NDArray[np.uint8]
    truth_row: NDArray[np.intp]


def judge(labels: Labels2D, truth: TruthTable, pairs: Pairs, *, min_iou: float, compare_classes: bool) -> Judgement:
    """Judge labels against the truth of their images; ``pairs`` are all (label, truth) that overlap."""
    count = len(labels.image)
    pairs = pairs[labels.counted[pairs.a]]
    may_match = truth.counted[pairs.b] & (pairs.iou >= min_iou)
    if compare_classes:
        may_match &= labels.label_class[pairs.a] == truth.category_class[pairs.b]
    rank = rank_labels(labels.image, labels.score, labels.xyxy_px)
    truth_row = match_greedily(pairs[may_match], rank, truth_count=len(truth))
    fallen = fallen_on_dont_care(pairs[~truth.counted[pairs.b]], label_count=count, min_iou=min_iou)
    outcome = np.full(count, FALSE_LABEL, np.uint8)
    outcome[fallen] = ABSORBED
    outcome[truth_row != UNMATCHED] = HIT
    return Judgement(outcome, truth_row)


@dataclass(frozen=True, eq=False)
class _LabelParts:
    """What is kept of the labels, part by part."""

    score: list[NDArray[np.float32]] = field(default_factory=list[NDArray[np.float32]])
    camera: list[NDArray[np.int16]] = field(default_factory=list[NDArray[np.int16]])
    outcome: dict[Criterion, list[NDArray[np.uint8]]] = field(default_factory=dict[Criterion, list[NDArray[np.uint8]]])


class Tally:
    """Counts one method: :meth:`add` labels part by part, then ask."""

    def __init__(self, truth: TruthTable, criteria: Sequence[Criterion], *, compare_classes: bool) -> None:
        self._truth = truth
        self._compare_classes = compare_classes
        self._labels = _LabelParts(outcome={criterion: [] for criterion in criteria})
        self._hit_score = {criterion: np.full(len(truth), np.nan, np.float32) for criterion in criteria}

    def add(self, labels: Labels2D, part_of_truth: slice, pairs: Mapping[str, Pairs]) -> None:
        """Count labels of whole images. ``part_of_truth`` are the rows of the truth that lie in these images;
        ``pairs`` are the (label, row of that part) that overlap, by kind of truth."""
        truth = self._truth[part_of_truth]
        counted = labels.counted
        self._labels.score.append(labels.score[counted])
        self._labels.camera.append(labels.camera[counted])
        for (kind, min_iou), outcomes in self._labels.outcome.items():
            judged = judge(labels, truth, pairs[kind], min_iou=min_iou, compare_classes=self._compare_classes)
            outcomes.append(judged.outcome[counted])
            hits = judged.truth_row != UNMATCHED
            self._hit_score[kind, min_iou][part_of_truth][judged.truth_row[hits]] = labels.score[hits]

    def counts(self, criterion: Criterion, *, confidence: float, cameras: Sequence[int] | None = None) -> Counts:
        """Counts of the labels with at least that confidence, over some cameras (by number) or all."""
        false_labels = (_joined(self._labels.outcome[criterion], np.uint8) == FALSE_LABEL) & (
            _joined(self._labels.score, np.float32) >= confidence
        )
        objects = self._truth.counted
        if cameras is not None:
            false_labels &= np.isin(_joined(self._labels.camera, np.int16), cameras)
            objects = objects & np.isin(self._truth.camera, cameras)
        tp, fn = self.found(criterion, objects, confidence=confidence)
        return Counts(tp=tp, fp=int(np.count_nonzero(false_labels)), fn=fn)

    def found(self, criterion: Criterion, objects: NDArray[np.bool_], *, confidence: float) -> tuple[int, int]:
        """How many of some objects (T,) bool, those that count, are found and missed at that confidence."""
        objects = objects & self._truth.counted
        with np.errstate(invalid="ignore"):
            tp = int(np.count_nonzero(objects & (self._hit_score[criterion] >= confidence)))
        return tp, int(np.count_nonzero(objects)) - tp

    def judged_scores(self, criterion: Criterion) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
        """Scores of all labels that are hits or false, (M,), and which of them are hits, (M,)."""
        outcome = _joined(self._labels.outcome[criterion], np.uint8)
        judged = outcome != ABSORBED
        return _joined(self._labels.score, np.float32)[judged], outcome[judged] == HIT

    @property
    def truth_count(self) -> int:
        """How many true objects count."""
        return int(np.count_nonzero(self._truth.counted))


def _joined(parts: list[NDArray[_Scalar]], dtype: type[_Scalar]) -> NDArray[_Scalar]:
    return np.concatenate(parts) if parts else np.zeros(0, dtype)
