"""How good a segmentation is on drives that it has not seen: intersection over union of each class, pixel by pixel.

The scores go through the room that paints LiDAR points: interpolated to every pixel, the likeliest class is the answer.
Intersections and unions are added up over all images (as in PASCAL VOC and Cityscapes)."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from labeler.drive.registry import open_drive
from labeler.segmentation import SegmentationScores, open_segmenter
from labeler.training.errors import TrainingError
from labeler.training.pictures import SEGMENTATION_CLASSES, pictures_of


@dataclass(frozen=True)
class ClassResult:
    """``iou`` of a class (None where neither shows it), and the ``truth_share`` of the pixels that show it."""

    name: str
    iou: float | None
    truth_share: float


@dataclass(frozen=True)
class SegmentationReport:
    """``images``, the ``results`` by class, the share of pixels that are right, and milliseconds of CPU an image takes
    on one core."""

    model: str
    drives: tuple[str, ...]
    images: int
    results: tuple[ClassResult, ...]
    right_share: float
    cpu_ms_per_image: float

    def as_json(self) -> dict[str, Any]:
        return asdict(self)


def validate_segmentation(model: Path, drives: Sequence[Path], advance: Callable[[], None]) -> SegmentationReport:
    """Run a segmentation file over drives with the class of each pixel; ``advance`` is called after each drive.
    TrainingError when a drive has no classes or the model has others, SegmentationError when the file is no such
    model."""
    segmenter = open_segmenter(model, providers=("CPUExecutionProvider",))
    unknown = set(SEGMENTATION_CLASSES).symmetric_difference(segmenter.class_names)
    if unknown:
        raise TrainingError(f"{model} was trained for other classes: {', '.join(segmenter.class_names)}.")
    number_of = np.array([SEGMENTATION_CLASSES.index(name) for name in segmenter.class_names])
    counts = np.zeros((len(SEGMENTATION_CLASSES),) * 2, np.int64)
    images, seconds = 0, 0.0
    for folder in drives:
        for picture in pictures_of(open_drive(folder)):
            if picture.semantic is None:
                raise TrainingError(
                    f"{folder} has no class of each pixel. Record it with hindsight simulate --semantic."
                )
            began = time.thread_time()
            scores = segmenter.segment(picture.image)
            seconds += time.thread_time() - began
            images += 1
            counts += confusion(picture.semantic, number_of[likeliest(scores)])
        advance()
    return SegmentationReport(
        model=model.name,
        drives=tuple(folder.name for folder in drives),
        images=images,
        results=results_of(counts),
        right_share=float(np.trace(counts) / max(counts.sum(), 1)),
        cpu_ms_per_image=1000 * seconds / max(images, 1),
    )


def likeliest(scores: SegmentationScores) -> NDArray[np.intp]:
    """(H, W) the plane of the likeliest class of every pixel."""
    width_px, height_px = scores.size_px
    rows, columns = np.indices((height_px, width_px), dtype=np.float32)
    middles = np.stack([columns.ravel(), rows.ravel()], axis=1) + np.float32(0.5)
    return scores.at(middles).argmax(axis=1).reshape(height_px, width_px)


def confusion(truth: NDArray[np.uint8], answer: NDArray[np.intp]) -> NDArray[np.int64]:
    """(C, C) how many pixels of each true class (rows) got each answer (columns)."""
    classes = len(SEGMENTATION_CLASSES)
    pairs = truth.astype(np.int64).ravel() * classes + answer.ravel()
    return np.bincount(pairs, minlength=classes * classes).reshape(classes, classes)


def results_of(counts: NDArray[np.int64]) -> tuple[ClassResult, ...]:
    """IoU of each class from how many pixels of each class got each answer."""
    right = np.diag(counts)
    union = counts.sum(axis=0) + counts.sum(axis=1) - right
    shares = counts.sum(axis=1) / max(int(counts.sum()), 1)
    return tuple(
        ClassResult(name, float(right[k] / union[k]) if union[k] else None, float(shares[k]))
        for k, name in enumerate(SEGMENTATION_CLASSES)
    )
