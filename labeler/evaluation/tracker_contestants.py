"""The trackers that are timed side by side: ours, and those of other packages where they are installed.

Each is given the same frames and puts them into its own form before the clock starts, so only tracking is timed. Every
tracker keeps its own defaults, except for what it must be told: the time between frames.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np

from labeler.evaluation.made_detections import PERIOD_NS
from labeler.tracking import DetectedFrame, TrackingConfig, open_tracker

Work = Callable[[], int]
"""Tracks all frames; the number of boxes that it gave a track."""

_PERIOD_S = PERIOD_NS / 1e9
_RATE_HZ = round(1 / _PERIOD_S)
_NORFAIR_DISTANCE = 0.7
"""norfair asks for a distance: 1 - IoU here, and an IoU of 0.3 is the usual gate of trackers by overlap."""


@dataclass(frozen=True)
class Contestant:
    """A tracker by ``name``. ``prepare`` takes frames into its form, and gives back the work to time.

    ``package`` is the name of the distribution that it comes from, None for ours; ``install`` the command that installs
    it."""

    name: str
    prepare: Callable[[Sequence[DetectedFrame]], Work]
    package: str | None = None
    install: str = ""

    @property
    def version(self) -> str | None:
        """Of its package; None for ours and where it is not installed."""
        try:
            return None if self.package is None else version(self.package)
        except PackageNotFoundError:
            return None

    def why_not(self, frames: Sequence[DetectedFrame]) -> str | None:
        """Why it can't take part, None where it can: it is tried on a few frames, and must find tracks in them. Ours
        has no reason not to, so its errors are raised."""
        if self.package is None:
            self.prepare(frames)()
            return None
        if self.version is None:
            return f"{self.package} is not installed: {self.install}"
        try:
            found = self.prepare(frames)()
        except Exception as error:  # what code of others may raise can't be known, and must not end the benchmark
            return f"{self.package} {self.version} does not work ({type(error).__name__}: {error}): {self.install}"
        return None if found else f"{self.package} {self.version} found nothing in {len(frames)} frames"


def _ours(method: str) -> Callable[[Sequence[DetectedFrame]], Work]:
    def prepare(frames: Sequence[DetectedFrame]) -> Work:
        tracker = open_tracker(TrackingConfig(method=method), class_groups=(0,))
        return lambda: sum(len(found) for found in tracker.track(frames, first_track_id=1))

    return prepare


def _motpy(frames: Sequence[DetectedFrame]) -> Work:
    motpy: Any = import_module("motpy")
    tracker = motpy.MultiObjectTracker(dt=_PERIOD_S)
    said = [
        [
            motpy.Detection(box, score, class_id=0)
            for box, score in zip(detections.xyxy_px.astype(np.float64), detections.score.tolist(), strict=True)
        ]
        for detections in (frame.detections for frame in frames)
    ]
    return lambda: sum(len(tracker.step(detections)) for detections in said)


def _trackers(frames: Sequence[DetectedFrame]) -> Work:
    tracker: Any = import_module("trackers").ByteTrackTracker(frame_rate=_RATE_HZ)
    said = _for_supervision(frames)
    return lambda: sum(int(np.count_nonzero(tracker.update(detections).tracker_id >= 0)) for detections in said)


def _supervision(frames: Sequence[DetectedFrame]) -> Work:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FutureWarning)  # it says that it will be gone, which is known here
        tracker: Any = import_module("supervision").ByteTrack(frame_rate=_RATE_HZ)
    said = _for_supervision(frames)
    return lambda: sum(len(tracker.update_with_detections(detections)) for detections in said)


def _for_supervision(frames: Sequence[DetectedFrame]) -> list[Any]:
    supervision: Any = import_module("supervision")
    return [
        supervision.Detections(
            xyxy=frame.detections.xyxy_px.copy(),
            confidence=frame.detections.score.copy(),
            class_id=frame.detections.class_id.astype(np.int64),
        )
        for frame in frames
    ]


def _norfair(frames: Sequence[DetectedFrame]) -> Work:
    norfair: Any = import_module("norfair")
    tracker = norfair.Tracker(distance_function="iou", distance_threshold=_NORFAIR_DISTANCE)
    said = [
        [
            norfair.Detection(box.reshape(2, 2), np.array([score, score]))
            for box, score in zip(detections.xyxy_px.astype(np.float64), detections.score.tolist(), strict=True)
        ]
        for detections in (frame.detections for frame in frames)
    ]
    return lambda: sum(len(tracker.update(detections=detections)) for detections in said)


CONTESTANTS = (
    Contestant("ours", _ours(TrackingConfig().method)),
    Contestant("ours-two_stage", _ours("two_stage")),
    Contestant("baseline", _ours("baseline")),
    Contestant("motpy", _motpy, "motpy", "pip install 'hindsight-labeler[bench]'"),
    Contestant("trackers", _trackers, "trackers", "pip install --no-deps trackers==2.6.1 supervision==0.29.1"),
    Contestant("norfair", _norfair, "norfair", "pip install --no-deps norfair==2.3.0"),
    Contestant("supervision", _supervision, "supervision", "pip install --no-deps supervision==0.29.1"),
)
"""In the order in which they are shown: ``ours`` is what ``hindsight label`` does unless told otherwise."""
