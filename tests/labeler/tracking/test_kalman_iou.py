"""The paper's tracker: what may begin a track. What it shares with others is in test_forward_trackers.py."""

import numpy as np
import pytest

from labeler.detection.types import Detections
from labeler.tracking import DetectedFrame, Observations, TrackingConfig
from labeler.tracking.kalman_iou import KalmanIouTracker

CAR = 0
GROUPS = (0, 0, 1)
TENTH_NS = 100_000_000

Row = tuple[float, float, float, float, float, int]  # x1, y1, x2, y2, score, class


def frame(index: int, *rows: Row) -> DetectedFrame:
    table = np.array(rows, np.float64).reshape(-1, 6)
    return DetectedFrame(
        index,
        index * TENTH_NS,
        Detections(table[:, :4].astype(np.float32), table[:, 4].astype(np.float32), table[:, 5].astype(np.int16)),
    )


def car(x: float, score: float = 0.9) -> Row:
    """A box 40 wide and 30 high, from x on."""
    return (x, 100, x + 40, 130, score, CAR)


def follow(*frames: DetectedFrame) -> list[Observations]:
    tracker = KalmanIouTracker(TrackingConfig(), class_groups=GROUPS)
    return list(tracker.track(frames, first_track_id=0))


def ids(observed: list[Observations]) -> list[list[int]]:
    return [observations.track_id.tolist() for observations in observed]


@pytest.mark.parametrize(
    ("scores", "expected"),
    [
        ([0.3, 0.1, 0.3], [[0], [0], [0]]),  # the thresholds themselves suffice
        ([0.29, 0.3, 0.1], [[], [0], [0]]),  # just below the first one a detection begins nothing
    ],
)
def test_scores(scores: list[float], expected: list[list[int]]) -> None:
    assert ids(follow(*(frame(i, car(0, score)) for i, score in enumerate(scores)))) == expected
