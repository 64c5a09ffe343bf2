"""Drives with true boxes in their images, camera by camera, as a detector sees them."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from labeler.detection import DetectionConfig, open_detector
from labeler.drive import Drive
from labeler.evaluation.sequences import DetectedSequence
from labeler.evaluation.truth import TruthTable, true_boxes_of
from labeler.evaluation.types import EvaluationConfig, EvaluationError
from labeler.pipeline import Progress, plan
from labeler.pipeline.artifacts import Artifacts
from labeler.pipeline.detecting import detect, read_detections


def sequences_of_drive(
    drive: Drive,
    *,
    model: Path,
    workspace: Path,
    detection: DetectionConfig,
    config: EvaluationConfig,
    progress: Progress,
    cameras: Sequence[str] = (),
    every: int = 1,
) -> Iterator[DetectedSequence]:
    """A sequence for each of the ``cameras``, all where none is named, of every so-manieth frame of the drive.

    The folder ``workspace`` keeps what is detected, as when the drive is labelled. EvaluationError where the drive has
    no true boxes in its images, or no such camera."""
    names = tuple(camera.name for camera in drive.cameras)
    missing = sorted(set(cameras) - set(names))
    if missing:
        raise EvaluationError(f"{drive.name} has no camera {missing[0]}. It has {', '.join(names)}.")
    table = true_boxes_of(drive, config)
    kept = replace(drive, frames=drive.frames[::every])
    detector = open_detector(model, detection)
    artifacts = Artifacts(workspace)
    units = [
        unit
        for unit in plan.detect_units(kept, detector, detection, artifacts=artifacts, model=model)
        if not cameras or unit.camera.name in cameras
    ]
    found = detect(units, detector, artifacts=artifacts, threads=os.cpu_count() or 1, progress=progress)
    classes = plan.Classes.of(detector)
    for camera, paths in plan.Clips.of(units, found.paths).by_camera().items():
        yield DetectedSequence(
            name=f"{drive.name}, {camera}",
            frames=tuple(read_detections(paths)),
            truth=_truth_of(table, names.index(camera), len(names), every),
            class_names=classes.names,
            class_groups=classes.groups,
            motion_of=partial(plan.motion_of, kept, camera, classes.names),
        )


def _truth_of(table: TruthTable, camera: int, camera_count: int, every: int) -> TruthTable:
    """The truth in one camera's images of those frames, numbered by frame."""
    frame = table.image // camera_count
    rows = np.flatnonzero((table.camera == camera) & (frame % every == 0))
    return replace(table[rows], image=frame[rows])
