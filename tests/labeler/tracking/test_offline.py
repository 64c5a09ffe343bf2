"""Passes that know the future, on drawn scenes."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labeler.detection.types import Detections
from labeler.tracking import NO_DETECTION, DetectedFrame, Observations, TrackingConfig
from labeler.tracking import offline as offline_module
from labeler.tracking.frames import FRAMES_READ_AT_ONCE
from labeler.tracking.offline import OfflineTracker

CAR, PERSON = 0, 2
GROUPS = (0, 0, 1)
TENTH_NS = 100_000_000
CONFIG = TrackingConfig(method="offline")

Row = tuple[float, float, float, float, float, int]


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


def follow(*frames: DetectedFrame, config: TrackingConfig = CONFIG) -> list[Observations]:
    return list(OfflineTracker(config, class_groups=GROUPS).track(frames, first_track_id=0))


def ids(observed: list[Observations]) -> list[list[int]]:
    return [observations.track_id.tolist() for observations in observed]


@pytest.mark.parametrize(
    ("unseen", "max_gap_s", "filled"),
    [
        (3, 0.4, 3),  # three frames are missing: 0.4 s lie between the detections around them
        (3, 0.3, 0),  # that is too long
        (9, 1.0, 9),
        (9, 0.9, 0),
        (3, 0.0, 0),  # nothing is ever filled
    ],
)
def test_short_gaps_are_filled(unseen: int, max_gap_s: float, filled: int) -> None:
    """It moves 5 px a frame; the filled boxes lie where it must have been, and no detection stands behind them."""
    frames = [frame(i, *([] if 10 <= i < 10 + unseen else [car(5 * i)])) for i in range(30)]
    gap = follow(*frames, config=replace(CONFIG, max_gap_s=max_gap_s))[10 : 10 + unseen]
    assert sum(len(observations) for observations in gap) == filled
    for index, observations in enumerate(gap, 10):
        if len(observations):
            assert observations.detection_index.tolist() == [NO_DETECTION]
            assert np.isnan(observations.score).all()
            assert observations.class_id.tolist() == [CAR]
            np.testing.assert_allclose(observations.xyxy_px, [[5 * index, 100, 5 * index + 40, 130]], atol=0.5)


def test_fragments_are_stitched_over_an_occlusion() -> None:
    """Hidden for 2 s, longer than a track coasts; it goes on at its speed of 2 px a frame."""
    frames = [frame(i, *([] if 20 <= i < 40 else [car(2 * i)])) for i in range(60)]
    assert {track for observed in ids(follow(*frames)) for track in observed} == {0}
    apart = follow(*frames, config=replace(CONFIG, max_stitch_s=0.0))
    assert len({track for observed in ids(apart) for track in observed}) == 2


def test_another_object_at_another_place_is_not_stitched() -> None:
    frames = [frame(i, *([] if 20 <= i < 40 else [car(2 * i + (200 if i >= 40 else 0))])) for i in range(60)]
    assert len({track for observed in ids(follow(*frames)) for track in observed}) == 2


@pytest.mark.parametrize(("follow_back", "expected"), [(True, {0}), (False, {0, 1})])
def test_followed_back(follow_back: bool, expected: set[int]) -> None:
    """Ten weak detections, then ten sure ones: a track of the weak ones, or one of all."""
    frames = [frame(i, car(3 * i, 0.4 if i < 10 else 0.9)) for i in range(20)]
    observed = follow(*frames, config=replace(CONFIG, follow_back=follow_back))
    assert len({track for tracks in ids(observed) for track in tracks}) == len(expected)
    assert all(len(observations) == 1 for observations in observed)


def test_a_loose_weak_box_is_refined() -> None:
    """In frame 10 a weak detection holds only the left half of the car."""
    frames = [frame(i, (0, 100, 20, 130, 0.5, CAR) if i == 10 else car(0)) for i in range(20)]
    refined = follow(*frames)[10]
    assert refined.xyxy_px[0, 2] > 35
    assert refined.detection_index.tolist() == [0]
    assert refined.score.tolist() == [0.5]
    assert follow(*frames, config=replace(CONFIG, refine=False))[10].xyxy_px[0].tolist() == [0, 100, 20, 130]


def test_of_two_tracks_on_one_object_the_weaker_has_no_boxes_there() -> None:
    frames = [frame(i, car(100, 0.9), *([car(100, 0.4, y=104)] if i < 5 else [])) for i in range(10)]
    observed = follow(*frames)
    assert ids(observed) == [ids(observed)[0]] * 10
    assert [observations.score.tolist() for observations in observed] == [[pytest.approx(0.9)]] * 10


def test_weak_tracks_take_nothing_from_sure_ones() -> None:
    """A weak object was there first; the sure one that lies over it in frame 5 keeps its detections."""
    frames = [frame(i, car(100, 0.4, y=104), *([car(100, 0.9)] if i >= 5 else [])) for i in range(10)]
    observed = follow(*frames, config=replace(CONFIG, min_iou_double=1))
    sure = [o.track_id[o.score > 0.5].tolist() for o in observed[5:]]
    assert sure == [sure[0]] * 5
    assert all(len(observations) == 2 for observations in observed[5:])


def test_windows_do_not_show(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same tracks and, to a hair, the same boxes, whether the drive is mended at once or 20 frames at a time."""
    random = np.random.default_rng(1)
    frames = [
        frame(i, *(car(4 * i + 300 * k + random.normal(), 0.9, y=90 * k) for k in range(3) if random.random() < 0.8))
        for i in range(150)
    ]
    whole = follow(*frames)
    monkeypatch.setattr(offline_module, "_FRAMES_AT_ONCE", 20)
    cut = follow(*frames, config=replace(CONFIG, look_ahead_s=3.0))
    assert ids(cut) == ids(whole)
    for one, other in zip(cut, whole, strict=True):
        np.testing.assert_allclose(one.xyxy_px, other.xyxy_px, atol=0.5)


def test_memory_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    """Frames are given out after a while, whatever follows: at most the frames that are given out and read at once,
    and the look-ahead."""
    monkeypatch.setattr(offline_module, "_FRAMES_AT_ONCE", 20)
    read = 0

    def frames() -> object:
        nonlocal read
        for index in range(300):
            read += 1
            yield frame(index, car(index))

    tracker = OfflineTracker(replace(CONFIG, look_ahead_s=2.0), class_groups=GROUPS)
    for given_out, _ in enumerate(tracker.track(frames(), first_track_id=0)):  # type: ignore[arg-type]
        assert read - given_out <= 20 + 20 + FRAMES_READ_AT_ONCE


@pytest.mark.parametrize(
    ("frames", "expected"),
    [
        ([], []),  # nothing recorded
        ([frame(0)], [[]]),  # an image without detections
        ([frame(0), frame(1), frame(2)], [[], [], []]),
        ([frame(0, car(0))], [[0]]),  # one image only
        ([frame(0, car(0), timestamp_ns=5), frame(1, car(1), timestamp_ns=5)], [[0], [0]]),  # no time passes
        ([frame(3, car(0)), frame(90, car(0))], [[0], [1]]),  # images missing for 8.7 s
        ([frame(0, car(0)), frame(1, car(0, np.nan)), frame(2, car(0))], [[0], [0], [0]]),  # filled: it can't be used
        ([frame(0, car(0)), frame(1, car(0, class_id=PERSON))], [[0], [1]]),  # a person is not the car
    ],
)
def test_degenerate_input(frames: list[DetectedFrame], expected: list[list[int]]) -> None:
    assert ids(follow(*frames)) == expected


def test_thousands_of_boxes() -> None:
    rows = [car(50.0 * (i % 60), y=50.0 * (i // 60)) for i in range(3000)]
    assert [len(observations) for observations in follow(frame(0, *rows), frame(1, *rows))] == [3000, 3000]


side = st.one_of(st.floats(-50, 300, width=32), st.sampled_from([float("nan"), float("inf"), 0.0, 1e30]))
score = st.one_of(st.floats(0, 1, width=32), st.just(float("nan")))
detection = st.tuples(side, side, side, side, score, st.integers(0, 2))
image = st.tuples(st.sampled_from([0, TENTH_NS, 3 * TENTH_NS, 20 * TENTH_NS]), st.lists(detection, max_size=6))


@settings(deadline=None, max_examples=60)
@given(st.lists(image, max_size=12), st.booleans())
def test_whatever_the_detector_says(images: list[tuple[int, list[Row]]], follow_back: bool) -> None:
    """No detection twice, no track twice in a frame, and every number finite but the score of what was filled in."""
    frames: list[DetectedFrame] = []
    timestamp_ns = 0
    for index, (step_ns, rows) in enumerate(images):
        timestamp_ns += step_ns
        frames.append(frame(index, *rows, timestamp_ns=timestamp_ns))
    observed = follow(*frames, config=replace(CONFIG, follow_back=follow_back))
    assert len(observed) == len(frames)
    for recorded, observations in zip(frames, observed, strict=True):
        detected = observations.detection_index != NO_DETECTION
        rows = observations.detection_index[detected]
        assert len(set(rows.tolist())) == len(rows)
        assert len(set(observations.track_id.tolist())) == len(observations)
        assert np.isfinite(observations.xyxy_px).all()
        assert (observations.xyxy_px[:, 2:] > observations.xyxy_px[:, :2]).all()
        np.testing.assert_array_equal(observations.score[detected], recorded.detections.score[rows])
        np.testing.assert_array_equal(np.isnan(observations.score), ~detected)
        assert ((observations.trust >= 0) & (observations.trust <= 1)).all()
