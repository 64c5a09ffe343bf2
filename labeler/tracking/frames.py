"""What every tracker asks of the frames that it is given."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from labeler.detection.types import Detections
from labeler.tracking.errors import TrackingError
from labeler.tracking.types import DetectedFrame

NS_PER_S = 1_000_000_000


def check_order(previous: DetectedFrame | None, frame: DetectedFrame) -> None:
    """TrackingError where ``frame`` does not come after ``previous``; at the same time is allowed."""
    if previous is None:
        return
    if frame.frame_index <= previous.frame_index or frame.timestamp_ns < previous.timestamp_ns:
        raise TrackingError(
            f"Frame {frame.frame_index} at {frame.timestamp_ns} ns came after frame {previous.frame_index} at "
            f"{previous.timestamp_ns} ns. A tracker needs the frames of one camera in order of time: sort them first."
        )


def sound_rows(detections: Detections) -> NDArray[np.intp]:
    """Rows with a finite score and a finite box that has an area."""
    x1, y1, x2, y2 = detections.xyxy_px.T.astype(np.float64)
    with np.errstate(invalid="ignore"):
        sound = np.isfinite(x1 + y1 + x2 + y2 + detections.score) & (x2 > x1) & (y2 > y1)
    return np.flatnonzero(sound)


def groups_of(frame: DetectedFrame, rows: NDArray[np.intp], class_groups: NDArray[np.int64]) -> NDArray[np.int64]:
    """(N,) group of each of these detections. TrackingError where a class has none."""
    class_id = frame.detections.class_id[rows]
    known = (class_id >= 0) & (class_id < len(class_groups))
    if not known.all():
        raise TrackingError(
            f"Frame {frame.frame_index} has a detection of class {class_id[~known][0]}, but the tracker knows the "
            f"groups of {len(class_groups)} classes only. Give it a group for every class of the detector."
        )
    return class_groups[class_id]
