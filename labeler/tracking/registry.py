"""The trackers that a configuration can name."""

from __future__ import annotations

from collections.abc import Sequence

from labeler.tracking.config import TrackingConfig
from labeler.tracking.errors import TrackingError
from labeler.tracking.kalman_iou import KalmanIouTracker
from labeler.tracking.types import Tracker

_TRACKERS = {"kalman_iou": KalmanIouTracker}


def open_tracker(config: TrackingConfig, *, class_groups: Sequence[int]) -> Tracker:
    """The tracker that ``config.method`` names.

    ``class_groups[class_id]`` is the number of the group whose classes may follow one another within a track. Raises
    TrackingError for a method that does not exist.
    """
    tracker = _TRACKERS.get(config.method)
    if tracker is None:
        raise TrackingError(f"There is no tracking method {config.method!r}. Choose one of: {', '.join(_TRACKERS)}.")
    return tracker(config, class_groups=class_groups)
