"""What a tracker says: which observations inside one camera are one object."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from labeler.detection.types import Detections

NO_DETECTION = -1


@dataclass(frozen=True, eq=False)
class DetectedFrame:
    """The detections of one camera's image in one frame of the drive."""

    frame_index: int
    timestamp_ns: int
    detections: Detections


@dataclass(frozen=True, eq=False)
class Observations:
    """Boxes of tracks in one camera, a row each.

    ``track_id`` (N,) int32, unique in the drive; ``frame_index`` (N,) int32; ``xyxy_px`` (N, 4) float32 in pixels;
    ``score`` (N,) float32 and ``class_id`` (N,) int16 as the detector said them; ``detection_index`` (N,) int32 is the
    row in the Detections of that camera and frame that fed this observation, or NO_DETECTION where the tracker filled
    the box in (then score is NaN). ``trust`` (N,) float32 in 0..1 is how likely the box shows the object that the track
    is of; 1 where the tracker does not judge, and where it is left out.
    """

    track_id: NDArray[np.int32]
    frame_index: NDArray[np.int32]
    xyxy_px: NDArray[np.float32]
    score: NDArray[np.float32]
    class_id: NDArray[np.int16]
    detection_index: NDArray[np.int32]
    trust: NDArray[np.float32] = field(default_factory=lambda: np.zeros(0, np.float32))

    def __post_init__(self) -> None:
        count = len(self.track_id)
        if count and len(self.trust) == 0:
            object.__setattr__(self, "trust", np.ones(count, np.float32))
        for name in ("frame_index", "score", "class_id", "detection_index", "trust"):
            if getattr(self, name).shape != (count,):
                raise ValueError(f"Observations.{name} must have shape ({count},), got {getattr(self, name).shape}")
        if self.xyxy_px.shape != (count, 4):
            raise ValueError(f"Observations.xyxy_px must have shape ({count}, 4), got {self.xyxy_px.shape}")

    def __len__(self) -> int:
        return len(self.track_id)

    def __getitem__(self, rows: NDArray[np.bool_] | NDArray[np.intp] | slice) -> Observations:
        return Observations(
            self.track_id[rows],
            self.frame_index[rows],
            self.xyxy_px[rows],
            self.score[rows],
            self.class_id[rows],
            self.detection_index[rows],
            self.trust[rows],
        )

    @staticmethod
    def empty() -> Observations:
        return Observations(
            np.zeros(0, np.int32),
            np.zeros(0, np.int32),
            np.zeros((0, 4), np.float32),
            np.zeros(0, np.float32),
            np.zeros(0, np.int16),
            np.zeros(0, np.int32),
        )


class Tracker(Protocol):
    """Follows objects through the images of one camera."""

    def track(self, frames: Iterable[DetectedFrame], *, first_track_id: int) -> Iterator[Observations]:
        """Observations frame by frame, in order of ``frame_index``; new tracks are numbered from ``first_track_id``
        upwards.
        """
        ...
