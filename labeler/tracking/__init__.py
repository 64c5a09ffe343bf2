"""Step 3: multi-object tracking inside one camera."""

from labeler.tracking.camera_motion import CameraMotion
from labeler.tracking.config import TrackingConfig
from labeler.tracking.errors import TrackingError
from labeler.tracking.registry import open_tracker
from labeler.tracking.types import NO_DETECTION, DetectedFrame, Observations, Tracker

__all__ = [
    "NO_DETECTION",
    "CameraMotion",
    "DetectedFrame",
    "Observations",
    "Tracker",
    "TrackingConfig",
    "TrackingError",
    "open_tracker",
]
