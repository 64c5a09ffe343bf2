"""What the made detections hold: the objects, their misses, jitter, weak scores and false boxes, and new objects."""

import numpy as np
import pytest

from labeler.evaluation.made_detections import (
    HEIGHT_PX,
    NOTHING,
    PERIOD_NS,
    WIDTH_PX,
    MadeDetections,
    make_detections,
)
from labeler.geometry.boxes_2d import iou_matrix

OBJECTS, FRAMES = 60, 100


@pytest.fixture(scope="module")
def made() -> MadeDetections:
    return make_detections(objects=OBJECTS, frames=FRAMES, seed=1)


def test_frames_in_order_of_time(made: MadeDetections) -> None:
    assert [frame.frame_index for frame in made.frames] == list(range(FRAMES))
    assert [frame.timestamp_ns for frame in made.frames] == [index * PERIOD_NS for index in range(FRAMES)]


def test_detections_by_descending_score(made: MadeDetections) -> None:
    for frame in made.frames:
        assert (np.diff(frame.detections.score) <= 0).all()
        assert ((frame.detections.score > 0) & (frame.detections.score < 1)).all()


def test_a_detection_lies_on_its_object(made: MadeDetections) -> None:
    for frame, object_id, true_id, true_px in zip(
        made.frames, made.object_id, made.true_id, made.true_xyxy_px, strict=True
    ):
        real = np.flatnonzero(object_id != NOTHING)
        assert len(set(object_id[real].tolist())) == len(real)  # none is detected twice
        place = {one: row for row, one in enumerate(true_id.tolist())}
        overlap = iou_matrix(frame.detections.xyxy_px[real], true_px)
        own = overlap[np.arange(len(real)), [place[one] for one in object_id[real].tolist()]]
        assert own.min(initial=1) > 0.4
        assert own.max(initial=0) < 1  # each jitters


def test_some_are_missed_some_are_weak_and_some_are_nothing(made: MadeDetections) -> None:
    seen = np.concatenate(made.object_id)
    score = np.concatenate([frame.detections.score for frame in made.frames])
    real = seen != NOTHING
    assert 0.75 < np.count_nonzero(real) / (OBJECTS * FRAMES) < 0.95
    assert 0.03 < np.count_nonzero(~real) / (OBJECTS * FRAMES) < 0.07
    assert 0.2 < np.mean(score[real] < 0.6) < 0.6
    assert score[~real].max() < 0.6


def test_objects_come_and_go_and_their_number_stays(made: MadeDetections) -> None:
    assert {len(one) for one in made.true_id} == {OBJECTS}
    assert len(set(np.concatenate(made.true_id).tolist())) > 1.5 * OBJECTS
    center = np.concatenate([(one[:, :2] + one[:, 2:]) / 2 for one in made.true_xyxy_px])
    assert ((center >= 0) & (center <= (WIDTH_PX, HEIGHT_PX))).all()


def test_equal_seeds_give_equal_arrays() -> None:
    one, same, other = (make_detections(objects=5, frames=10, seed=seed) for seed in (3, 3, 4))
    for a, b in zip(one.frames, same.frames, strict=True):
        np.testing.assert_array_equal(a.detections.xyxy_px, b.detections.xyxy_px)
        np.testing.assert_array_equal(a.detections.score, b.detections.score)
    assert not np.array_equal(one.true_xyxy_px[0], other.true_xyxy_px[0])
