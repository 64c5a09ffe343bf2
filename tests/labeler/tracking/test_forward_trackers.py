"""What every tracker that goes forward in time does, on drawn scenes: which detection goes to which track."""

from collections.abc import Callable, Iterator

import numpy as np
import pytest

from labeler.detection.types import Detections
from labeler.tracking import DetectedFrame, Observations, Tracker, TrackingConfig, TrackingError
from labeler.tracking.frames import FRAMES_READ_AT_ONCE
from labeler.tracking.kalman_iou import KalmanIouTracker
from labeler.tracking.two_stage import TwoStageTracker

CAR, TRUCK, PERSON = 0, 1, 2
GROUPS = (0, 0, 1)
TENTH_NS = 100_000_000

Row = tuple[float, float, float, float, float, int]  # x1, y1, x2, y2, score, class
Follow = Callable[..., list[Observations]]


@pytest.fixture(params=[KalmanIouTracker, TwoStageTracker])
def tracker(request: pytest.FixtureRequest) -> KalmanIouTracker | TwoStageTracker:
    return request.param(TrackingConfig(), class_groups=GROUPS)


@pytest.fixture
def follow(tracker: Tracker) -> Follow:
    def through(*frames: DetectedFrame, first_track_id: int = 0) -> list[Observations]:
        return list(tracker.track(frames, first_track_id=first_track_id))

    return through


def frame(index: int, *rows: Row, timestamp_ns: int | None = None) -> DetectedFrame:
    table = np.array(rows, np.float64).reshape(-1, 6)
    return DetectedFrame(
        index,
        index * TENTH_NS if timestamp_ns is None else timestamp_ns,
        Detections(table[:, :4].astype(np.float32), table[:, 4].astype(np.float32), table[:, 5].astype(np.int16)),
    )


def car(x: float, score: float = 0.9, class_id: int = CAR, *, y: float = 100) -> Row:
    """A box 40 wide and 30 high, from x on."""
    return (x, y, x + 40, y + 30, score, class_id)


def ids(observed: list[Observations]) -> list[list[int]]:
    return [observations.track_id.tolist() for observations in observed]


def test_one_object_one_track_and_its_rows(follow: Follow) -> None:
    observed = follow(frame(0, car(0)), frame(1, car(4)), first_track_id=7)
    assert ids(observed) == [[7], [7]]
    second = observed[1]
    assert second.frame_index.tolist() == [1]
    assert second.xyxy_px.tolist() == [[4, 100, 44, 130]]  # the detection's box, not the filtered one
    assert second.score.tolist() == [np.float32(0.9)]
    assert second.class_id.tolist() == [CAR]
    assert second.detection_index.tolist() == [0]


def test_two_objects_crossing_keep_their_tracks(follow: Follow) -> None:
    """Left to right and right to left at 10 px a frame, 8 px apart in y; they lie over one another in frame 10."""
    frames = [frame(i, car(10 * i), car(200 - 10 * i, y=108)) for i in range(21)]
    assert ids(follow(*frames)) == [[0, 1]] * 21


def test_a_hidden_object_comes_back_as_itself(follow: Follow) -> None:
    """It moves 6 px a frame, is hidden for 8 frames (0.9 s), and is found where it must have gone."""
    frames = [frame(i, *([] if 10 <= i < 18 else [car(6 * i)])) for i in range(25)]
    assert ids(follow(*frames)) == [[0]] * 10 + [[]] * 8 + [[0]] * 7


@pytest.mark.parametrize(
    ("gap_s", "expected"),
    [
        (0.5, 0),  # still coasting
        (1.2, 0),  # as long as a track may coast
        (1.3, 1),  # longer
        (5.0, 1),  # the recording paused
    ],
)
def test_a_gap_in_time_ends_tracks(follow: Follow, gap_s: float, expected: int) -> None:
    still = car(0)
    observed = follow(frame(0, still, timestamp_ns=0), frame(1, still, timestamp_ns=round(gap_s * 1e9)))
    assert ids(observed)[1] == [expected]


@pytest.mark.parametrize(
    ("classes", "expected"),
    [
        ([CAR, TRUCK, CAR], [0, 0, 0]),  # the detector's class flickers inside the group
        ([CAR, PERSON, CAR], [0, 1, 0]),  # a person in front of the car is not the car
    ],
)
def test_class_groups(follow: Follow, classes: list[int], expected: list[int]) -> None:
    observed = follow(*(frame(i, car(0, class_id=class_id)) for i, class_id in enumerate(classes)))
    assert [row[0] for row in ids(observed)] == expected
    assert [observations.class_id[0] for observations in observed] == classes  # as the detector said it


@pytest.mark.parametrize(
    ("scores", "expected"),
    [
        ([0.9, 0.15, 0.9], [[0], [0], [0]]),  # a weak detection continues a track
        ([0.25, 0.25, 0.9], [[], [], [0]]),  # and never begins one
        ([0.9, 0.05, 0.9], [[0], [], [0]]),  # below the least score it is ignored
    ],
)
def test_scores(follow: Follow, scores: list[float], expected: list[list[int]]) -> None:
    assert ids(follow(*(frame(i, car(0, score)) for i, score in enumerate(scores)))) == expected


def test_a_weak_detection_takes_no_track_from_a_strong_one(follow: Follow) -> None:
    """The weak box lies exactly where the track is, the strong one 10 px beside it (IoU 0.6)."""
    observed = follow(frame(0, car(0)), frame(1, car(10, 0.8), car(0, 0.2)))
    assert ids(observed) == [[0], [0]]
    assert observed[1].detection_index.tolist() == [0]


def test_detection_index_names_the_row(follow: Follow) -> None:
    """Two tracks; then the rows come in another order, after a row that is ignored and one that is broken."""
    first = frame(0, car(0), car(200))
    second = frame(1, car(0, 0.01), car(0, np.nan), car(203), car(3))
    observed = follow(first, second)[1]
    assert observed.track_id.tolist() == [1, 0]
    assert observed.detection_index.tolist() == [2, 3]
    np.testing.assert_array_equal(observed.xyxy_px, second.detections.xyxy_px[[2, 3]])


def scene(rate_hz: int) -> list[DetectedFrame]:
    """Two seconds of three cars, one of which is hidden from 0.6 s until 1.4 s, seen rate_hz times a second."""
    frames: list[DetectedFrame] = []
    for index in range(2 * rate_hz):
        seconds = index / rate_hz
        rows = [car(60 * seconds), car(300 - 40 * seconds, y=200)]
        if not 0.6 < seconds < 1.4:
            rows.append(car(500 + 30 * seconds, y=300))
        frames.append(frame(index, *rows, timestamp_ns=round(seconds * 1e9)))
    return frames


@pytest.mark.parametrize("rate_hz", [5, 10, 20, 50])
def test_any_frame_rate_gives_the_same_tracks(follow: Follow, rate_hz: int) -> None:
    observed = follow(*scene(rate_hz))
    assert {tuple(row) for row in ids(observed)} == {(0, 1, 2), (0, 1)}


@pytest.mark.parametrize(
    ("row", "why"),
    [
        ((0, 0, 10, 10, np.nan, CAR), "score is not a number"),
        ((0, 0, 10, 10, np.inf, CAR), "score is infinite"),
        ((0, np.nan, 10, 10, 0.9, CAR), "box is not finite"),
        ((5, 0, 5, 10, 0.9, CAR), "no width"),
        ((0, 10, 10, 0, 0.9, CAR), "upside down"),
    ],
)
def test_broken_detections_are_rejected_and_counted(
    tracker: KalmanIouTracker | TwoStageTracker, row: Row, why: str
) -> None:
    observed = list(tracker.track([frame(0, row, car(100)), frame(1, row, car(100))], first_track_id=0))
    assert [o.detection_index.tolist() for o in observed] == [[1], [1]], why
    assert tracker.rejected_count == 2


@pytest.mark.parametrize(
    ("frames", "expected"),
    [
        ([], []),  # nothing recorded
        ([frame(0)], [[]]),  # an image without detections
        ([frame(0, car(0))], [[0]]),  # one image only
        ([frame(0, car(0)), frame(1), frame(2, car(0))], [[0], [], [0]]),  # an empty one between
        ([frame(0, car(0), timestamp_ns=5), frame(1, car(1), timestamp_ns=5)], [[0], [0]]),  # no time passes
        ([frame(3, car(0)), frame(9, car(0))], [[0], [0]]),  # images missing for 0.6 s
        (
            [frame(0, (0, 0, 1e-3, 1e-3, 0.9, CAR)), frame(1, (0, 0, 1e-3, 1e-3, 0.9, CAR))],
            [[0], [1]],
        ),  # smaller than a pixel
        ([frame(0, (0, 0, 1e30, 1e30, 0.9, CAR)), frame(1, (0, 0, 1e30, 1e30, 0.9, CAR))], [[0], [0]]),  # huge boxes
    ],
)
def test_degenerate_input(follow: Follow, frames: list[DetectedFrame], expected: list[list[int]]) -> None:
    assert ids(follow(*frames)) == expected


def test_a_thousand_boxes(follow: Follow) -> None:
    rows = [car(50.0 * (i % 40), y=50.0 * (i // 40)) for i in range(1000)]
    assert ids(follow(frame(0, *rows), frame(1, *rows))) == [list(range(1000))] * 2


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (frame(0, timestamp_ns=10), frame(1, timestamp_ns=9)),  # time runs back
        (frame(4), frame(4)),  # the same frame twice
        (frame(4), frame(3, timestamp_ns=10**10)),  # frames run back
    ],
)
def test_frames_out_of_order_are_an_error(follow: Follow, first: DetectedFrame, second: DetectedFrame) -> None:
    with pytest.raises(TrackingError, match=f"Frame {second.frame_index} .* came after frame {first.frame_index}"):
        follow(first, second)


@pytest.mark.parametrize("class_id", [3, -1])
def test_a_class_without_group_is_an_error(follow: Follow, class_id: int) -> None:
    with pytest.raises(TrackingError, match=f"Frame 0 has a detection of class {class_id}"):
        follow(frame(0, car(0, class_id=class_id)))


def test_frames_stream(tracker: KalmanIouTracker | TwoStageTracker) -> None:
    """The observations of a frame are there before more frames are read than are read at once."""
    read = 0

    def recorded() -> Iterator[DetectedFrame]:
        nonlocal read
        for index in range(3 * FRAMES_READ_AT_ONCE):
            read += 1
            yield frame(index, car(0))

    given_out = 0
    for given_out, _ in enumerate(tracker.track(recorded(), first_track_id=0), start=1):
        assert read <= given_out - 1 + FRAMES_READ_AT_ONCE
    assert given_out == 3 * FRAMES_READ_AT_ONCE


def test_a_tracker_starts_anew_for_each_camera(tracker: KalmanIouTracker | TwoStageTracker) -> None:
    for first_track_id in (0, 5):
        observed = list(tracker.track([frame(0, car(0)), frame(1, car(0))], first_track_id=first_track_id))
        assert ids(observed) == [[first_track_id]] * 2
