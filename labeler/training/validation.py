"""Measures a trained file on unseen drives, whichever of the models it is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from labeler.inference import CPU_PROVIDER
from labeler.inference.sessions import open_session
from labeler.models import SHIPPED, Task
from labeler.segmentation import open_segmenter
from labeler.training.detector_validation import DetectorReport, validate_detector
from labeler.training.pillar_validation import PillarReport, validate_pillars
from labeler.training.segmentation_validation import SegmentationReport, validate_segmentation


def validate_model(
    model: Path, drives: Sequence[Path], advance: Callable[[], None]
) -> DetectorReport | SegmentationReport | PillarReport:
    """What the file's metadata say it does decides; without them it is taken for a detector. The segmentation that
    ships paints the points of a pillar network. ``advance`` is called after each drive."""
    metadata = open_session(model, providers=(CPU_PROVIDER,), intra_op_threads=1).metadata
    if metadata.get("task") == "segmentation":
        return validate_segmentation(model, drives, advance)
    if metadata.get("task") == "pillars":
        painter = next(shipped.path for shipped in SHIPPED if shipped.task is Task.SEGMENTATION)
        return validate_pillars(model, drives, open_segmenter(painter, providers=(CPU_PROVIDER,)), advance)
    return validate_detector(model, drives, advance)
