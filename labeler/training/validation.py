"""Measures a trained file on unseen drives, whichever of the two models it is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from labeler.inference.sessions import open_session
from labeler.training.detector_validation import DetectorReport, validate_detector
from labeler.training.segmentation_validation import SegmentationReport, validate_segmentation


def validate_model(
    model: Path, drives: Sequence[Path], advance: Callable[[], None]
) -> DetectorReport | SegmentationReport:
    """What the file's metadata say it does decides; without them it is taken for a detector. ``advance`` is called
    after each drive."""
    metadata = open_session(model, providers=("CPUExecutionProvider",), intra_op_threads=1).metadata
    if metadata.get("task") == "segmentation":
        return validate_segmentation(model, drives, advance)
    return validate_detector(model, drives, advance)
