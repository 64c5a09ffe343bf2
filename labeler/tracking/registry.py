"""The trackers that a configuration can name."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module

from labeler.tracking.config import TrackingConfig
from labeler.tracking.errors import TrackingError
from labeler.tracking.types import Tracker

_TRACKERS = {"kalman_iou": "labeler.tracking.kalman_iou:KalmanIouTracker"}
"""Where each tracker is: loaded when it is chosen, because its libraries are slow to load."""


def open_tracker(config: TrackingConfig, *, class_groups: Sequence[int]) -> Tracker:
    """The tracker that ``config.method`` names.

    ``class_groups[class_id]`` is the number of the group whose classes may follow one another within a track. Raises
    TrackingError for a method that does not exist.
    """
    place = _TRACKERS.get(config.method)
    if place is None:
        raise TrackingError(f"There is no tracking method {config.method!r}. Choose one of: {', '.join(_TRACKERS)}.")
    module, _, name = place.partition(":")
    make: Callable[..., Tracker] = getattr(import_module(module), name)
    return make(config, class_groups=class_groups)
