"""How many frames a tracker does in a second of processor time, beside those of other packages.

All track the same made detections (:mod:`labeler.evaluation.made_detections`). The clock is the processor time of the
whole process, so other programs on the machine and threads started by a library can't flatter anyone. Trackers take
turns, each round beginning with another one, and the median over the rounds counts, because machines slow down and
speed up. It all happens in a worker process in which numerical libraries have been told to use one thread before they
are loaded.
"""

from __future__ import annotations

import gc
import statistics
import time
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any, TypedDict

from labeler.evaluation.made_detections import make_detections
from labeler.evaluation.tracker_contestants import CONTESTANTS, Contestant

OBJECTS = (20, 60, 100, 300)
"""Objects in each image; the last is a crowd."""

_WARM_UP_FRAMES = 20
_ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"), "1"
)


class TrackerRow(TypedDict):
    """One tracker's speed on images with so many objects."""

    tracker: str
    objects: int
    frames_per_cpu_second: float


class SkippedTracker(TypedDict):
    """A tracker that could not take part, and why."""

    tracker: str
    reason: str


class TrackerTimes(TypedDict):
    """``versions`` holds those of the packages that took part."""

    rows: list[TrackerRow]
    skipped: list[SkippedTracker]
    versions: dict[str, str]
    frames: int
    runs: int
    seed: int


class TimedRound(TypedDict):
    """Seconds of processor time by tracker, and who was skipped."""

    seconds: dict[str, float]
    skipped: list[SkippedTracker]
    versions: dict[str, str]


def benchmark_trackers(
    *,
    objects: Sequence[int] = OBJECTS,
    frames: int = 500,
    runs: int = 3,
    seed: int = 0,
    progress: Callable[[], object] = lambda: None,
) -> TrackerTimes:
    """Time every tracker ``runs`` times on each number of objects; ``progress`` is called after each round of all.

    A tracker that is not installed or fails is named in ``skipped``."""
    loky: Any = import_module("loky")  # it has no types of its own
    rounds: dict[int, list[TimedRound]] = {count: [] for count in objects}
    with loky.ProcessPoolExecutor(1, env=_ONE_THREAD) as worker:
        for run in range(runs):
            for count in objects:
                rounds[count].append(worker.submit(time_round, count, frames, seed, run).result())
                progress()
    return summarise(rounds, frames=frames, runs=runs, seed=seed)


def time_round(
    objects: int, frames: int, seed: int, turn: int, contestants: Sequence[Contestant] = CONTESTANTS
) -> TimedRound:
    """Time each tracker once; the one in place ``turn`` begins."""
    _hold_opencv_to_one_thread()
    made = make_detections(objects=objects, frames=frames, seed=seed).frames
    found = TimedRound(seconds={}, skipped=[], versions={})
    first = turn % len(contestants)
    for contestant in (*contestants[first:], *contestants[:first]):
        reason = contestant.why_not(made[:_WARM_UP_FRAMES])
        if reason is not None:
            found["skipped"].append(SkippedTracker(tracker=contestant.name, reason=reason))
            continue
        if contestant.version is not None:
            found["versions"][contestant.name] = contestant.version
        work = contestant.prepare(made)
        gc.collect()
        start = time.process_time()
        work()
        found["seconds"][contestant.name] = time.process_time() - start
    return found


def summarise(rounds: dict[int, list[TimedRound]], *, frames: int, runs: int, seed: int) -> TrackerTimes:
    """A row for each tracker and number of objects, in the order of the trackers."""
    every = [one for of_count in rounds.values() for one in of_count]
    skipped = {one["tracker"]: one for found in every for one in found["skipped"]}
    names = [contestant.name for contestant in CONTESTANTS if contestant.name not in skipped]
    rows = [
        TrackerRow(
            tracker=name,
            objects=count,
            frames_per_cpu_second=round(frames / statistics.median(one["seconds"][name] for one in of_count), 1),
        )
        for name in names
        for count, of_count in rounds.items()
    ]
    versions = {name: version for found in every for name, version in found["versions"].items() if name in names}
    return TrackerTimes(
        rows=rows, skipped=list(skipped.values()), versions=versions, frames=frames, runs=runs, seed=seed
    )


def _hold_opencv_to_one_thread() -> None:
    """Some packages bring OpenCV, which has threads of its own and heeds no variable."""
    cv2: Any = import_module("cv2")
    cv2.setNumThreads(1)
