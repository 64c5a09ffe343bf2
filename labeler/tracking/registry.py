"""The trackers that a configuration can name."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module

from labeler.tracking.config import TrackingConfig
from labeler.tracking.types import Tracker

_TRACKERS = {
    "baseline": "labeler.tracking.kalman_iou:KalmanIouTracker",
    "offline": "labeler.tracking.offline:OfflineTracker",
    "two_stage": "labeler.tracking.two_stage:TwoStageTracker",
}
"""Where each tracker is: loaded when it is chosen, because its libraries are slow to load."""


def open_tracker(config: TrackingConfig, *, class_groups: Sequence[int]) -> Tracker:
    """The tracker that ``config.method`` names.

    ``class_groups[class_id]`` is the number of the group whose classes may follow one another within a track.
    """
    module, _, name = _TRACKERS[config.method].partition(":")
    make: Callable[..., Tracker] = getattr(import_module(module), name)
    return make(config, class_groups=class_groups)
