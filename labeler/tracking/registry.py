"""The trackers that a configuration can name."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module

from labeler.tracking.camera_motion import CameraMotion
from labeler.tracking.config import TrackingConfig
from labeler.tracking.types import Tracker

_TRACKERS = {
    "baseline": "labeler.tracking.kalman_iou:KalmanIouTracker",
    "offline": "labeler.tracking.offline:OfflineTracker",
    "two_stage": "labeler.tracking.two_stage:TwoStageTracker",
}
"""Where each tracker is: loaded when it is chosen, because its libraries are slow to load."""


def open_tracker(config: TrackingConfig, *, class_groups: Sequence[int], motion: CameraMotion | None = None) -> Tracker:
    """The tracker that ``config.method`` names.

    ``class_groups[class_id]`` is the number of the group whose classes may follow one another within a track.
    ``motion`` is that of the camera, where it is known; the paper's tracker does not take it.
    """
    module, _, name = _TRACKERS[config.method].partition(":")
    make: Callable[..., Tracker] = getattr(import_module(module), name)
    if config.method == "baseline":
        return make(config, class_groups=class_groups)
    return make(config, class_groups=class_groups, motion=motion)
