"""Settings of the tracking step."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from labeler.tracking.errors import TrackingError

METHODS = ("offline", "two_stage", "baseline")
EGO_MOTIONS = ("full", "rotation", "none")


@dataclass(frozen=True)
class TrackingConfig:
    """Plain values, so that the step's artifact can be keyed by them. The defaults assume 2 to 30 images a second.

    A "size" below is the geometric mean of a box's width and height, so that near and far objects are treated alike.
    """

    method: str = "offline"
    """Which tracker: ``baseline`` is the paper's own variant, ``two_stage`` associates sure detections before weak
    ones, ``offline`` adds passes that know the future."""

    ego_motion: str = "full"
    """What of the car's own motion boxes are predicted by, where poses and calibration are known: its turns and its way
    (``full``), its turns (``rotation``), or nothing (``none``). The paper's variant takes nothing."""

    birth_score: float = 0.3
    """A detection with at least this score may begin a track (two-stage: see ``sure_score``)."""

    sure_score: float = 0.45
    """A detection with at least this score chooses its track before the others and may begin one (two-stage only)."""

    min_score: float = 0.1
    """A detection with at least this score may continue a track; one below is ignored."""

    min_iou: float = 0.1
    """A detection feeds a track only if it overlaps the box predicted for it by at least this much."""

    min_iou_sure: float = 0.05
    """The same for a detection of at least ``sure_score`` in two-stage association."""

    min_iou_weak: float = 0.3
    """The same for the other detections in two-stage association: what is less sure must fit better."""

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

    max_stitch_s: float = 3.0
    """Offline: the longest time between the end of one fragment of an object and the beginning of the next."""

    min_iou_stitch: float = 0.4
    """Offline: how much the paths of two fragments must overlap in the middle of the gap between them."""

    max_gap_s: float = 1.0
    """Offline: boxes are filled in where nothing was detected for at most this long; 0 fills nothing."""

    follow_back: bool = False
    """Offline: follow tracks back in time from their beginning, over detections that no other track has."""

    min_iou_back: float = 0.5
    """Offline: the least overlap of a detection with a track that is followed back."""

    min_iou_double: float = 0.5
    """Offline: two tracks are of one object where their boxes overlap by at least this much in ``double_share`` of the
    frames that have both; then the one that was seen worse loses the boxes that lie on the other's. 1: only where they
    are the same."""

    double_share: float = 0.5
    """Offline: see ``min_iou_double``."""

    refine: bool = True
    """Offline: boxes of observations are those of the smooth path; False keeps the detector's own."""

    smooth_measurement_std_sizes: float = 0.02
    """Offline: like ``measurement_std_sizes``, for a detection as sure as the track's best, when smoothing."""

    smooth_speed_change_std_sizes: float = 2.0
    """Offline: like ``speed_change_std_sizes``, when smoothing."""

    smooth_growth_ratio: float = 1.0
    """Offline: like ``growth_ratio``, when smoothing: the future tells growth from noise."""

    look_ahead_s: float = 5.0
    """Offline: how much of the future a frame waits for, and how much of the past is kept."""

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            raise TrackingError(f"There is no tracking method {self.method!r}. Choose one of: {', '.join(METHODS)}.")
        if self.ego_motion not in EGO_MOTIONS:
            raise TrackingError(
                f"There is no ego motion {self.ego_motion!r} to predict by. Choose one of: {', '.join(EGO_MOTIONS)}."
            )
        for field in fields(self):
            value: object = getattr(self, field.name)
            if isinstance(value, int | float) and not (math.isfinite(value) and value >= 0):
                raise TrackingError(f"Tracking setting {field.name} must be a number of 0 or more, got {value}.")
        if self.min_score > self.birth_score:
            raise TrackingError(
                f"Tracking setting min_score ({self.min_score}) must not exceed birth_score ({self.birth_score}): "
                "a detection that may begin a track must be one that may continue it."
            )
        for name in (
            "min_iou",
            "min_iou_sure",
            "min_iou_weak",
            "min_iou_stitch",
            "min_iou_back",
            "min_iou_double",
            "double_share",
        ):
            if not 0 < getattr(self, name) <= 1:
                raise TrackingError(
                    f"Tracking setting {name} must be above 0 and at most 1, got {getattr(self, name)}."
                )
        for name in ("measurement_std_sizes", "smooth_measurement_std_sizes"):
            if getattr(self, name) == 0:
                raise TrackingError(f"Tracking setting {name} must be above 0: no detector is exact.")
