"""Tracks of which it is known which true object each shows: what merging is calibrated on.

They come from made observations (:mod:`labeler.evaluation.benchmark_merges`), or from a real detector on a drive with
truth, whose boxes and tracks err in ways that no model of noise has: tracks of one or two boxes, boxes that hold two
cars, false boxes at the same post in every frame.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from labeler.detection.classes import suppression_group_of
from labeler.drive import Drive
from labeler.evaluation.benchmark_merges import TrackedScene
from labeler.evaluation.owners import objects_of_tracks
from labeler.evaluation.types import EvaluationError
from labeler.evaluation.usual_labelling import label_as_usual
from labeler.identity import CameraView, MultiCameraFrame, Rig
from labeler.pipeline import LabelSettings
from labeler.pipeline.plan import rig_of


@dataclass(frozen=True, eq=False)
class OwnedTracks:
    """``frames`` of tracks as the identity step takes them. ``object_of`` names the true object of each track, None
    where it shows none; those of which that is not clear are missing from it. ``colours`` are the histograms of tracks,
    as far as they are known."""

    frames: Sequence[MultiCameraFrame]
    object_of: Mapping[int, str | None]
    class_groups: tuple[int, ...]
    rig: Rig
    colours: Mapping[int, NDArray[np.float32]] = field(default_factory=dict[int, "NDArray[np.float32]"])


def of_scene(tracked: TrackedScene) -> OwnedTracks:
    """Those of made observations."""
    object_of = {track: str(owner) if owner >= 0 else None for track, owner in tracked.object_of.items()}
    return OwnedTracks(tracked.frames, object_of, tracked.class_groups, tracked.rig)


def of_detector(drive: Drive, model: Path, *, workspace: Path, settings: LabelSettings) -> OwnedTracks:
    """Those that the pipeline finds in a drive's images. ``workspace`` keeps its artifacts.

    EvaluationError when the drive has no true boxes in its images."""
    truth = drive.read_truth(drive.frames)
    if truth is None or truth.boxes_2d is None:
        raise EvaluationError(f"{drive.root} has no true boxes in its images, so nobody knows whose its tracks are.")
    labelled = label_as_usual(drive, model=model, workspace=workspace, settings=settings)
    frames = [
        MultiCameraFrame(
            frame.frame_index,
            {
                camera: CameraView(view.observations, view.boxes_3d, view.positions)
                for camera, view in frame.views.items()
            },
        )
        for frame in labelled.frames()
    ]
    cameras = {track.camera for track in labelled.tracks}
    observations = {camera: list(labelled.observations(camera)) for camera in cameras}
    object_of = objects_of_tracks(truth.boxes_2d, observations)
    groups: tuple[int, ...] = tuple(suppression_group_of(labelled.class_names).tolist())
    return OwnedTracks(frames, object_of, groups, rig_of(drive), labelled.open_colours())
