"""Tracking and propagation on real detections: more true cars get a label that is sure enough to train on."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from labeler.detection.types import Detections
from labeler.geometry.boxes_2d import iou_matrix
from labeler.propagation import collect_votes, label_observations
from labeler.tracking import DetectedFrame, Observations, TrackingConfig, open_tracker

SURE = 0.8
MIN_IOU = 0.25


def detected_frames(path: Path) -> list[DetectedFrame]:
    """Rows are frame, x1, y1, x2, y2, score; ten frames a second."""
    table = np.loadtxt(path, delimiter=",", ndmin=2)
    frames: list[DetectedFrame] = []
    for index in range(int(table[:, 0].max()) + 1):
        rows = table[table[:, 0] == index].astype(np.float32)
        cars = Detections(rows[:, 1:5], rows[:, 5], np.zeros(len(rows), np.int16))
        frames.append(DetectedFrame(index, index * 100_000_000, cars))
    return frames


def true_cars(path: Path) -> dict[int, NDArray[np.float64]]:
    """Boxes of the cars within 80 m, by frame."""
    cars: dict[int, list[list[float]]] = {}
    for line in path.read_text().splitlines():
        words = line.split()
        if words[2] == "Car" and np.hypot(float(words[13]), float(words[15])) <= 80:
            cars.setdefault(int(words[0]), []).append([float(word) for word in words[6:10]])
    return {frame_index: np.array(boxes) for frame_index, boxes in cars.items()}


def found_cars(boxes: NDArray[np.float32], score: NDArray[np.float32], truth: NDArray[np.float64]) -> int:
    """How many true cars a sure label overlaps by MIN_IOU; a label is good for one car, best scores first."""
    free = np.ones(len(truth), np.bool_)
    for row in np.argsort(-score, kind="stable"):
        overlap = iou_matrix(boxes[row : row + 1].astype(np.float64), truth)[0] * free
        if score[row] >= SURE and overlap.max() >= MIN_IOU:
            free[overlap.argmax()] = False
    return int(np.count_nonzero(~free))


@pytest.mark.real_drive
def test_recall_rises_by_a_tenth(kitti_tracking_text: Path) -> None:
    before, after = 0, 0
    tracker = open_tracker(TrackingConfig(), class_groups=(0,))
    for detected in sorted((kitti_tracking_text / "det_yolox_car_nothr").glob("*.txt")):
        frames = detected_frames(detected)
        truth = true_cars(kitti_tracking_text / "label_02" / detected.name)
        observed: list[Observations] = list(tracker.track(frames, first_track_id=0))
        votes = collect_votes((("front", observations) for observations in observed), {})
        for frame, observations in zip(frames, observed, strict=True):
            cars = truth.get(frame.frame_index)
            if cars is None:
                continue
            labels = label_observations(observations, {}, votes)
            before += found_cars(frame.detections.xyxy_px, frame.detections.score, cars)
            after += found_cars(observations.xyxy_px, labels.score, cars)
    assert before > 0
    assert after >= 1.1 * before, f"{before} true cars found without tracking, {after} with"
