"""How good a detector is on drives that it has not seen: average precision over visible boxes.

Counted as ``hindsight evaluate`` counts detections (classes compared, the surest chooses first, truth outside the scope
is neither hit nor miss), through the same room that labels drives, so that the figures hold for the file as it is used.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from labeler.detection.config import DetectionConfig
from labeler.detection.types import Detections
from labeler.detection.yolox import YoloxDetector, open_detector
from labeler.drive.images import read_image
from labeler.drive.registry import open_drive
from labeler.drive.types import Drive
from labeler.evaluation.categories import CLASSES, class_of_labels
from labeler.evaluation.counting import Labels2D, Tally
from labeler.evaluation.curves import average_precision, precision_recall_at
from labeler.evaluation.matching import overlapping_pairs
from labeler.evaluation.truth import TruthTable, image_number, prepare_truth
from labeler.evaluation.types import EvaluationConfig
from labeler.training.errors import TrainingError

_MIN_SCORE = 0.01
_IOU = 0.5
_CONFIDENCE = 0.8
_DISTANCES_M = (0.0, 10.0, 20.0, 30.0, 40.0, 60.0, 80.0)


@dataclass(frozen=True)
class Scope:
    """Which vehicles are asked for: up to ``max_distance_m``, with at least 30 visible pixels, whose visible box has a
    longer side above ``longer_side_px`` and a shorter one above ``shorter_side_px``; of ``class_name`` or of all."""

    max_distance_m: float = 80.0
    min_distance_m: float = 0.0
    longer_side_px: float = 0.0
    shorter_side_px: float = 0.0
    class_name: str | None = None

    def counts(self, truth: TruthTable, visible_px: NDArray[np.float32]) -> NDArray[np.bool_]:
        """(T,) which rows of the truth are asked for."""
        sides = visible_px[:, 2:] - visible_px[:, :2]
        with np.errstate(invalid="ignore"):
            asked = truth.counted & (truth.distance_m <= self.max_distance_m)
            asked &= truth.distance_m >= self.min_distance_m
        asked &= (sides.max(axis=1, initial=0) > self.longer_side_px) & (sides.min(axis=1) > self.shorter_side_px)
        return asked if self.class_name is None else asked & (truth.category_class == CLASSES.index(self.class_name))


@dataclass(frozen=True)
class ScopeResult:
    """Of the vehicles in a scope, at IoU 0.5: how many there are, average precision (classes compared and not), and
    precision and recall of the boxes with a score of at least 0.8."""

    name: str
    truth_count: int
    average_precision: float | None
    average_precision_any_class: float | None
    precision_at_confidence: float | None
    recall_at_confidence: float | None


@dataclass(frozen=True)
class DetectorReport:
    """``images``, the ``results`` by scope, and milliseconds of CPU an image takes on one core."""

    model: str
    drives: tuple[str, ...]
    images: int
    results: tuple[ScopeResult, ...]
    cpu_ms_per_image: float

    def as_json(self) -> dict[str, Any]:
        return asdict(self)


SCOPES: dict[str, Scope] = {
    "within 40 m, longer side above 12 px": Scope(40.0, longer_side_px=12.0),
    "within 40 m, both sides above 12 px": Scope(40.0, shorter_side_px=12.0),
    "within 80 m": Scope(80.0),
    **{
        f"{name}, within 40 m, longer side above 12 px": Scope(40.0, longer_side_px=12.0, class_name=name)
        for name in CLASSES[:4]
    },
    **{
        f"{start:.0f} to {stop:.0f} m, longer side above 12 px": Scope(stop, start, longer_side_px=12.0)
        for start, stop in pairwise(_DISTANCES_M)
    },
}


@dataclass(frozen=True, eq=False)
class _Seen:
    """What a drive gave: the truth, the detections as labels, and the pairs of them that overlap."""

    truth: TruthTable
    visible_px: NDArray[np.float32]
    labels: Labels2D


@dataclass(eq=False)
class _Clock:
    images: int = 0
    seconds: float = 0.0


def validate_detector(model: Path, drives: Sequence[Path], advance: Callable[[], None]) -> DetectorReport:
    """Run a detector file over drives with truth; ``advance`` is called after each drive. TrainingError when a drive
    has no visible boxes, DetectionError when the file is no detector."""
    detector = open_detector(model, DetectionConfig(min_score=_MIN_SCORE), providers=("CPUExecutionProvider",))
    seen: list[_Seen] = []
    clock = _Clock()
    for folder in drives:
        seen.append(_look(detector, open_drive(folder), clock))
        advance()
    return DetectorReport(
        model=model.name,
        drives=tuple(folder.name for folder in drives),
        images=clock.images,
        results=tuple(_result(name, scope, seen) for name, scope in SCOPES.items()),
        cpu_ms_per_image=1000 * clock.seconds / max(clock.images, 1),
    )


def _look(detector: YoloxDetector, drive: Drive, clock: _Clock) -> _Seen:
    cameras = [camera.name for camera in drive.cameras]
    truth = drive.read_truth(drive.frames)
    table = None if truth is None else prepare_truth(truth, cameras, EvaluationConfig(max_distance_m=np.inf))
    if table is None or table.visible_px is None:
        raise TrainingError(f"{drive.root} has no visible true boxes (annotations_2d.feather) to compare with.")
    found: list[Detections] = []
    image: list[int] = []
    for frame in drive.frames:
        for number, name in enumerate(cameras):
            if name not in frame.images:
                continue
            picture = read_image(frame.images[name], drive.camera(name))
            began = time.thread_time()
            found += detector.detect([picture])
            clock.seconds += time.thread_time() - began
            clock.images += 1
            frame_index, camera = np.array([frame.index], np.int32), np.array([number], np.int16)
            image += image_number(frame_index, camera, len(cameras)).tolist()
    counts = [len(boxes) for boxes in found]
    numbers = np.repeat(np.array(image, np.int64), counts)
    label_class = class_of_labels(detector.class_names)[np.concatenate([boxes.class_id for boxes in found])]
    labels = Labels2D(
        image=numbers,
        camera=(numbers % len(cameras)).astype(np.int16),
        xyxy_px=np.concatenate([boxes.xyxy_px for boxes in found]),
        label_class=label_class,
        score=np.concatenate([boxes.score for boxes in found]),
    )
    return _Seen(table, table.boxes_px("visible"), labels)


def _result(name: str, scope: Scope, seen: Sequence[_Seen]) -> ScopeResult:
    score, is_hit, truth_count = _judged(scope, seen, compare_classes=True)
    any_score, any_hit, _ = _judged(scope, seen, compare_classes=False)
    precision, recall = precision_recall_at(score, is_hit, np.array([_CONFIDENCE]), truth_count=truth_count)
    return ScopeResult(
        name=name,
        truth_count=truth_count,
        average_precision=average_precision(score, is_hit, truth_count=truth_count),
        average_precision_any_class=average_precision(any_score, any_hit, truth_count=truth_count),
        precision_at_confidence=float(precision[0]) if (score >= _CONFIDENCE).any() else None,
        recall_at_confidence=float(recall[0]) if truth_count else None,
    )


def _judged(
    scope: Scope, seen: Sequence[_Seen], *, compare_classes: bool
) -> tuple[NDArray[np.float32], NDArray[np.bool_], int]:
    """Scores of all boxes that are hits or false, which are hits, and how many vehicles are asked for."""
    scores: list[NDArray[np.float32]] = []
    hits: list[NDArray[np.bool_]] = []
    truth_count = 0
    for drive in seen:
        truth = replace(drive.truth, counted=scope.counts(drive.truth, drive.visible_px))
        labels = drive.labels
        if scope.class_name is not None:
            of_class = labels.label_class == CLASSES.index(scope.class_name)
            labels = replace(labels, score=np.where(of_class, labels.score, np.nan).astype(np.float32))
        pairs = overlapping_pairs(labels.image, labels.xyxy_px, truth.image, drive.visible_px)
        tally = Tally(truth, [("visible", _IOU)], compare_classes=compare_classes)
        tally.add(labels, slice(None), {"visible": pairs})
        drive_score, drive_hit = tally.judged_scores(("visible", _IOU))
        scores.append(drive_score)
        hits.append(drive_hit)
        truth_count += tally.truth_count
    return np.concatenate(scores), np.concatenate(hits), truth_count
