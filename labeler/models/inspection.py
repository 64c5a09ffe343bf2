"""What a model file is: opened by the step that would use it, so that what is taken in can also be run."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from labeler.detection import DetectionError
from labeler.detection.model import YoloxModel
from labeler.inference import CPU_PROVIDER
from labeler.models.registry import Task
from labeler.segmentation import SegmentationError
from labeler.segmentation.model import SegmentationModel


@dataclass(frozen=True)
class Inspected:
    """The task of a file, the shape of its input (batch x channels x height x width, free sizes as letters) and the
    names of its classes."""

    task: Task
    input_shape: str
    class_names: tuple[str, ...]


def inspect(path: Path) -> Inspected:
    """Open a file as a detector, else as a segmentation.

    Raises ModelError where it is neither, or can't be opened at all."""
    try:
        detector = YoloxModel(path, providers=(CPU_PROVIDER,)).layout
    except DetectionError as no_detector:
        try:
            segmentation = SegmentationModel(path, providers=(CPU_PROVIDER,)).layout
        except SegmentationError as no_segmentation:
            raise DetectionError(f"{no_detector} Nor is it a segmentation: {no_segmentation}") from no_segmentation
        shape = _shape(segmentation.batch, segmentation.height, segmentation.width)
        return Inspected(Task.SEGMENTATION, shape, segmentation.class_names)
    return Inspected(Task.DETECTION, _shape(detector.batch, detector.height, detector.width), detector.class_names)


def _shape(batch: int | None, height: int | None, width: int | None) -> str:
    return f"{batch or 'N'}x3x{height or 'H'}x{width or 'W'}"
