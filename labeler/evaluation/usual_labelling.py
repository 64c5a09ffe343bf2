"""Labels a drive with the networks that it gets where nobody names any: curves are fitted on what users have."""

from __future__ import annotations

from pathlib import Path

from labeler.drive import Drive, is_simulated
from labeler.models import ModelCache, choose_boxes, choose_segmentation
from labeler.pipeline import LabelledDrive, LabelSettings, label_drive


def label_as_usual(
    drive: Drive, *, model: Path, workspace: Path, settings: LabelSettings | None = None
) -> LabelledDrive:
    """Label ``drive`` with the detector in the file ``model``, keeping artifacts in ``workspace``; errors as those of
    :func:`labeler.pipeline.label_drive`."""
    cache, simulated = ModelCache(workspace / "models"), is_simulated(drive.root)
    segmentation = choose_segmentation(None, cache, simulated=simulated)
    boxes = choose_boxes(None, cache, simulated=simulated)
    return label_drive(
        drive,
        model=model,
        segmentation=None if segmentation is None else segmentation.path,
        boxes=None if boxes is None else boxes.path,
        workspace=workspace,
        settings=settings,
    )
