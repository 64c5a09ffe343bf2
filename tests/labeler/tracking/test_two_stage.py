"""Two-stage association: its thresholds, on drawn scenes, and beside the baseline on the same ones. What it shares with
other trackers is in test_forward_trackers.py."""

import numpy as np
import pytest

from labeler.detection.types import Detections
from labeler.tracking import DetectedFrame, Observations, TrackingConfig
from labeler.tracking.kalman_iou import KalmanIouTracker
from labeler.tracking.two_stage import TwoStageTracker

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


def car(x: float, score: float = 0.9, *, y: float = 100) -> Row:
    """A box 40 wide and 30 high, from x on."""
    return (x, y, x + 40, y + 30, score, CAR)


def follow(*frames: DetectedFrame, config: TrackingConfig | None = None) -> list[Observations]:
    tracker = TwoStageTracker(config or TrackingConfig(), class_groups=GROUPS)
    return list(tracker.track(frames, first_track_id=0))


def ids(observed: list[Observations]) -> list[list[int]]:
    return [observations.track_id.tolist() for observations in observed]


@pytest.mark.parametrize(
    ("scores", "expected"),
    [
        ([0.44, 0.44, 0.9], [[], [], [0]]),  # a detection that is not sure begins nothing
        ([0.45, 0.1, 0.45], [[0], [0], [0]]),  # the thresholds themselves suffice
    ],
)
def test_scores(scores: list[float], expected: list[list[int]]) -> None:
    assert ids(follow(*(frame(i, car(0, score)) for i, score in enumerate(scores)))) == expected


@pytest.mark.parametrize(("overlap_px", "expected"), [(22, [0]), (15, [])])
def test_a_weak_detection_must_fit_better(overlap_px: int, expected: list[int]) -> None:
    """Of 40 px: 22 in common are an IoU of 22 / 58 = .38, 15 are 15 / 65 = .23, with .3 asked for."""
    assert ids(follow(frame(0, car(0)), frame(1, car(40 - overlap_px, 0.3))))[1] == expected


@pytest.mark.parametrize("seed", range(4))
def test_one_threshold_gives_the_tracks_of_the_baseline(seed: int) -> None:
    """Thirty objects that drift, vanish and come back: the same detections in the same tracks."""
    random = np.random.default_rng(seed)
    place, speed = random.uniform(0, 600, (30, 2)), random.normal(0, 6, (30, 2))
    frames: list[DetectedFrame] = []
    for index in range(40):
        place = place + speed
        seen = place[random.random(30) < 0.8] + random.normal(0, 1, 2)
        rows = [car(x, score, y=y) for (x, y), score in zip(seen, random.uniform(0.1, 1, len(seen)), strict=True)]
        frames.append(frame(index, *rows))
    config = TrackingConfig(sure_score=0.3, min_iou_sure=0.1, min_iou_weak=0.1)
    expected = list(KalmanIouTracker(config, class_groups=GROUPS).track(frames, first_track_id=0))
    observed = follow(*frames, config=config)
    assert ids(observed) == ids(expected)
    assert [o.detection_index.tolist() for o in observed] == [o.detection_index.tolist() for o in expected]
