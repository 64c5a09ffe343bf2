"""Tracks of which it is known which true object each shows: what merging is calibrated on.

They come from made observations (:mod:`labeler.evaluation.benchmark_merges`), or from a real detector on a drive with
truth, whose boxes and tracks err in ways that no model of noise has: tracks of one or two boxes, boxes that hold two
cars, false boxes at the same post in every frame.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from labeler.detection.classes import suppression_group_of
from labeler.drive import Drive
from labeler.evaluation.benchmark_merges import TrackedScene
from labeler.evaluation.merges import count_true_objects
from labeler.evaluation.types import EvaluationError
from labeler.identity import CameraView, MultiCameraFrame, Rig
from labeler.pipeline import LabelSettings, label_drive
from labeler.pipeline.plan import rig_of

_MIN_IOU = 0.3
_CLEAR_SHARE = 0.7
_OWN_SHARE = 0.5
_STRAY_SHARE = 0.2


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

    A box shows the true object that it overlaps by an IoU of at least 0.3. A track shows the one that at least half of
    its boxes show, and 70 % of those that show any; it shows none where less than a fifth of its boxes do.
    EvaluationError when the drive has no true boxes in its images."""
    truth = drive.read_truth(drive.frames)
    if truth is None or truth.boxes_2d is None:
        raise EvaluationError(f"{drive.root} has no true boxes in its images, so nobody knows whose its tracks are.")
    labelled = label_drive(drive, model=model, workspace=workspace, settings=settings)
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
    object_of: dict[int, str | None] = {}
    for camera in {track.camera for track in labelled.tracks}:
        counts = count_true_objects(truth.boxes_2d, camera, labelled.observations(camera), min_iou=_MIN_IOU)
        for track in (track for track in labelled.tracks if track.camera == camera):
            of_object, boxes = counts.get(track.track_id, Counter[str]()), track.observation_count
            owner, count = next(iter(of_object.most_common(1)), (None, 0))
            if of_object.total() < _STRAY_SHARE * boxes:
                object_of[track.track_id] = None
            elif count >= max(_OWN_SHARE * boxes, _CLEAR_SHARE * of_object.total()):
                object_of[track.track_id] = owner
    groups: tuple[int, ...] = tuple(suppression_group_of(labelled.class_names).tolist())
    return OwnedTracks(frames, object_of, groups, rig_of(drive), labelled.open_colours())
