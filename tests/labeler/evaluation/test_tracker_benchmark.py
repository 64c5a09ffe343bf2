"""The benchmark of trackers: who takes part, on what, what comes out, and that ours finds what it is timed on."""

import re
from collections.abc import Callable, Sequence

import numpy as np
import pytest

from labeler.evaluation.made_detections import NOTHING, make_detections
from labeler.evaluation.tracker_benchmark import (
    SkippedTracker,
    TimedRound,
    benchmark_trackers,
    summarise,
    time_round,
)
from labeler.evaluation.tracker_contestants import CONTESTANTS, Contestant
from labeler.tracking import NO_DETECTION, DetectedFrame, TrackingConfig, open_tracker

OURS = ("ours", "ours-two_stage", "baseline")
PEERS = ("motpy", "trackers", "norfair", "supervision")


def test_who_takes_part() -> None:
    assert tuple(contestant.name for contestant in CONTESTANTS) == OURS + PEERS


def test_everyone_is_fed_the_same_and_begins_in_turn() -> None:
    fed: list[tuple[str, list[DetectedFrame]]] = []

    def recorder(name: str) -> Callable[[Sequence[DetectedFrame]], Callable[[], int]]:
        def prepare(frames: Sequence[DetectedFrame]) -> Callable[[], int]:
            fed.append((name, list(frames)))
            return lambda: 1

        return prepare

    contestants = [Contestant(name, recorder(name)) for name in "abc"]
    found = time_round(5, 30, 0, 1, contestants)
    assert [name for name, frames in fed if len(frames) == 30] == ["b", "c", "a"]
    first = fed[1][1]
    assert all(one is other for _, frames in fed for one, other in zip(frames, first, strict=False))
    assert set(found["seconds"]) == {"a", "b", "c"}


def _raises(frames: Sequence[DetectedFrame]) -> Callable[[], int]:
    raise AttributeError("module has no ByteTrack")


@pytest.mark.parametrize(
    ("contestant", "reason"),
    [
        (
            Contestant("absent", _raises, "no-such-package-at-all", "pip install it"),
            "no-such-package-at-all is not installed: pip install it",
        ),
        (
            Contestant("broken", _raises, "numpy", "pip install another"),
            "numpy .* does not work .*no ByteTrack.*another",
        ),
        (Contestant("blind", lambda _: lambda: 0, "numpy"), "found nothing"),
    ],
)
def test_who_can_not_is_skipped_with_a_reason(contestant: Contestant, reason: str) -> None:
    found = time_round(5, 20, 0, 0, [contestant])
    assert found["seconds"] == {}
    assert [one["tracker"] for one in found["skipped"]] == [contestant.name]
    assert re.search(reason, found["skipped"][0]["reason"])


def test_an_error_of_ours_is_not_hidden() -> None:
    with pytest.raises(AttributeError):
        time_round(5, 20, 0, 0, [Contestant("ours", _raises)])


def test_the_median_counts() -> None:
    """100 frames in 1, 2 and 4 seconds; who was skipped has no row."""
    absent = SkippedTracker(tracker="motpy", reason="not installed")
    seconds = dict.fromkeys([contestant.name for contestant in CONTESTANTS if contestant.name != "motpy"], 5.0)
    rounds = [
        TimedRound(seconds={**seconds, "ours": of_ours}, skipped=[absent], versions={}) for of_ours in (1.0, 4.0, 2.0)
    ]
    found = summarise({20: rounds}, frames=100, runs=3, seed=0)
    assert found["rows"][0] == {"tracker": "ours", "objects": 20, "frames_per_cpu_second": 50.0}
    assert "motpy" not in {row["tracker"] for row in found["rows"]}
    assert found["skipped"] == [absent]


def test_rows_of_a_real_run() -> None:
    rounds = 0

    def advance() -> None:
        nonlocal rounds
        rounds += 1

    found = benchmark_trackers(objects=(5, 8), frames=20, runs=2, progress=advance)
    assert rounds == 4
    skipped = {one["tracker"] for one in found["skipped"]}
    expected = [name for name in OURS + PEERS if name not in skipped]
    assert [(row["tracker"], row["objects"]) for row in found["rows"]] == [(n, o) for n in expected for o in (5, 8)]
    assert all(row["frames_per_cpu_second"] > 0 for row in found["rows"])
    assert all(one["reason"] for one in found["skipped"])
    assert set(expected) >= set(OURS)


@pytest.mark.parametrize("name", PEERS)
def test_a_peer_that_is_installed_finds_the_objects(name: str) -> None:
    contestant = next(one for one in CONTESTANTS if one.name == name)
    if contestant.version is None:
        pytest.skip(f"{name} is not installed: {contestant.install}")
    made = make_detections(objects=10, frames=40, seed=0)
    assert contestant.prepare(made.frames)() > 40 * 10 / 2


def test_ours_finds_the_objects() -> None:
    """Nearly all detections of an object are in tracks, and most of each object's in one."""
    made = make_detections(objects=20, frames=100, seed=0)
    tracks_of: dict[int, list[int]] = {}
    detected = 0
    tracker = open_tracker(TrackingConfig(), class_groups=(0,))
    for found, object_id in zip(tracker.track(made.frames, first_track_id=0), made.object_id, strict=True):
        detected += np.count_nonzero(object_id != NOTHING)
        rows = np.flatnonzero(found.detection_index != NO_DETECTION)
        for track, one in zip(found.track_id[rows], object_id[found.detection_index[rows]], strict=True):
            if one != NOTHING:
                tracks_of.setdefault(int(one), []).append(int(track))
    assert sum(len(tracks) for tracks in tracks_of.values()) > 0.95 * detected
    in_main = sum(np.bincount(tracks).max() for tracks in tracks_of.values())
    assert in_main > 0.85 * detected
