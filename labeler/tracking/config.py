"""Settings of the tracking step."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from labeler.tracking.errors import TrackingError


@dataclass(frozen=True)
class TrackingConfig:
    """Plain values, so that the step's artifact can be keyed by them. The defaults assume 2 to 30 images a second.

    A "size" below is the geometric mean of a box's width and height, so that near and far objects are treated alike.
    """

    method: str = "kalman_iou"
    """Which tracker: the paper's own variant is ``kalman_iou``."""

    birth_score: float = 0.3
    """A detection with at least this score may begin a track."""

    min_score: float = 0.1
    """A detection with at least this score may continue a track; one below is ignored."""

    min_iou: float = 0.1
    """A detection feeds a track only if it overlaps the box predicted for it by at least this much."""

    max_coast_s: float = 1.2
    """A track that no detection has fed for longer than this has ended, in seconds (the paper: 12 images at 10 Hz)."""

    measurement_std_sizes: float = 0.05
    """How far a detected box is off, in sizes (standard deviation of centre, width and height)."""

    initial_speed_std_sizes: float = 2.0
    """How fast a new object may move, in sizes a second (standard deviation of the centre's speed)."""

    speed_change_std_sizes: float = 1.0
    """How much the speed changes within one second, in sizes a second (standard deviation of the centre's speed)."""

    growth_ratio: float = 0.2
    """How fast width and height change, compared with the centre: a turning camera moves boxes, it grows none."""

    def __post_init__(self) -> None:
        for field in fields(self):
            value: object = getattr(self, field.name)
            if isinstance(value, int | float) and not (math.isfinite(value) and value >= 0):
                raise TrackingError(f"Tracking setting {field.name} must be a number of 0 or more, got {value}.")
        if self.min_score > self.birth_score:
            raise TrackingError(
                f"Tracking setting min_score ({self.min_score}) must not exceed birth_score ({self.birth_score}): "
                "a detection that may begin a track must be one that may continue it."
            )
        if not 0 < self.min_iou <= 1:
            raise TrackingError(f"Tracking setting min_iou must be above 0 and at most 1, got {self.min_iou}.")
        if self.measurement_std_sizes == 0:
            raise TrackingError("Tracking setting measurement_std_sizes must be above 0: no detector is exact.")
