"""What a model file is: opened by the step that would use it, so that what is taken in can also be run."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from labeler.detection import DetectionError
from labeler.detection.model import YoloxModel
from labeler.inference import CPU_PROVIDER, ModelError, OpenSession, open_session
from labeler.models.registry import Task
from labeler.segmentation import SegmentationError
from labeler.segmentation.model import SegmentationModel

PILLARS = "pillars"
"""What a pillar network's file says of its task."""

_NAMES = TypeAdapter(tuple[str, ...])


@dataclass(frozen=True)
class Inspected:
    """The task of a file, the shape of its input (batch x channels x height x width, or pillars x points x features;
    free sizes as letters) and the names of its classes."""

    task: Task
    input_shape: str
    class_names: tuple[str, ...]


def inspect(path: Path) -> Inspected:
    """Take a file for a pillar network where it says so, else open it as a detector, else as a segmentation.

    Raises ModelError where it is none of them, or can't be opened at all."""
    session = open_session(path, providers=(CPU_PROVIDER,), intra_op_threads=1)
    if session.metadata.get("task") == PILLARS:
        return _pillars(session, path)
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


def _pillars(session: OpenSession, path: Path) -> Inspected:
    """By what the file says about itself: the room that runs it stands above this one."""
    points = next((item.shape for item in session.inputs if item.name == "points"), None)
    try:
        names = _NAMES.validate_json(session.metadata.get("classes", ""))
    except ValidationError as error:
        raise ModelError(f"{path} says that it finds pillars, but not which classes. Train it again.") from error
    if points is None:
        raise ModelError(f"{path} says that it finds pillars, but it takes no points. Train it again.")
    return Inspected(Task.BOXES, "x".join(str(size) if isinstance(size, int) else "N" for size in points), names)


def _shape(batch: int | None, height: int | None, width: int | None) -> str:
    return f"{batch or 'N'}x3x{height or 'H'}x{width or 'W'}"
