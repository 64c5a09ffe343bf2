"""What a detector saw in one camera, beside the truth: what tracking and propagation are measured on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from labeler.evaluation.truth import TruthTable
from labeler.tracking import CameraMotion, DetectedFrame, TrackingConfig


def without_motion(config: TrackingConfig) -> None:
    """The motion of a camera whose poses nobody recorded."""


@dataclass(frozen=True, eq=False)
class DetectedSequence:
    """The detections of a camera, frame by frame, and its true boxes, whose ``image`` is the index of the frame.

    ``class_names`` and ``class_groups`` are those of the detector; ``motion_of`` gives how the camera moves as far as a
    tracker of those settings wants to know it."""

    name: str
    frames: tuple[DetectedFrame, ...]
    truth: TruthTable
    class_names: tuple[str, ...]
    class_groups: tuple[int, ...]
    motion_of: Callable[[TrackingConfig], CameraMotion | None] = without_motion
