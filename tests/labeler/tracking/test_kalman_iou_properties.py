"""What holds for the tracker whatever the detector says."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from labeler.detection.types import Detections
from labeler.tracking import DetectedFrame, TrackingConfig
from labeler.tracking.kalman_iou import KalmanIouTracker

CONFIG = TrackingConfig()
side = st.one_of(st.floats(-50, 300, width=32), st.sampled_from([float("nan"), float("inf"), 0.0]))
score = st.one_of(st.floats(0, 1, width=32), st.just(float("nan")))
detection = st.tuples(side, side, side, side, score, st.integers(0, 2))
image = st.tuples(st.integers(0, 2_000_000_000), st.lists(detection, max_size=8))


@settings(deadline=None, max_examples=60)
@given(st.lists(image, max_size=8))
def test_every_detection_at_most_once_and_nothing_invented(
    images: list[tuple[int, list[tuple[float, float, float, float, float, int]]]],
) -> None:
    frames: list[DetectedFrame] = []
    timestamp_ns = 0
    for index, (step_ns, rows) in enumerate(images):
        timestamp_ns += step_ns
        table = np.array(rows, np.float64).reshape(-1, 6)
        detections = Detections(
            table[:, :4].astype(np.float32), table[:, 4].astype(np.float32), table[:, 5].astype(np.int16)
        )
        frames.append(DetectedFrame(index, timestamp_ns, detections))

    tracker = KalmanIouTracker(CONFIG, class_groups=(0, 0, 1))
    observed = list(tracker.track(frames, first_track_id=100))

    assert len(observed) == len(frames)
    groups: dict[int, set[int]] = {}
    highest = 99
    for frame, observations in zip(frames, observed, strict=True):
        rows = observations.detection_index
        assert len(set(rows.tolist())) == len(rows)
        assert len(set(observations.track_id.tolist())) == len(rows)
        assert observations.frame_index.tolist() == [frame.frame_index] * len(rows)
        np.testing.assert_array_equal(observations.xyxy_px, frame.detections.xyxy_px[rows])
        np.testing.assert_array_equal(observations.score, frame.detections.score[rows])
        assert np.isfinite(observations.xyxy_px).all()
        assert (observations.score >= np.float32(CONFIG.min_score)).all()
        for track_id, class_id, row_score in zip(
            observations.track_id.tolist(), observations.class_id.tolist(), observations.score.tolist(), strict=True
        ):
            if track_id not in groups:  # new tracks are numbered upwards, and begin with a strong detection
                assert track_id == highest + 1
                assert row_score >= CONFIG.birth_score
                highest = track_id
            groups.setdefault(track_id, set()).add((0, 0, 1)[class_id])
    assert all(len(of_track) == 1 for of_track in groups.values())
