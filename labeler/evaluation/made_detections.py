"""What a detector could say about one camera's images, made from a seed: to time trackers without images or a model.

Objects cross the image on nearly straight paths. Each is missed now and then, for one frame or for a while as if
something stood before it, its boxes jitter, and its score wavers around one of its own, so that some detections are
weak. Some detections lie on nothing. An object that leaves or has been there long enough makes room for a new one, so
tracks begin and end all the time while the number of objects stays.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.detection.types import Detections
from labeler.tracking import DetectedFrame

NOTHING = -1
"""The object of a false detection."""

WIDTH_PX, HEIGHT_PX = 1920, 1080
PERIOD_NS = 100_000_000

_PERIOD_S = PERIOD_NS / 1e9
_SIZES_PX = (20.0, 120.0)
_ASPECTS = (0.6, 2.0)
_LIVES_S = (2.0, 20.0)
_SPEED_STD_SIZES = 0.7
_SPEED_CHANGE_STD_SIZES = 0.2
_SCORES = (0.4, 0.95)
_SCORE_STD = 0.08
_JITTER_STD_SIZES = 0.04
_MISSED = 0.05
_HIDES = 0.01
_HIDDEN_FRAMES = (3, 15)
_FALSE_SHARE = 0.05
_FALSE_SCORES = (0.1, 0.5)


@dataclass(frozen=True, eq=False)
class MadeDetections:
    """F frames at 10 Hz, all of one class. Of each frame: ``object_id`` (N,) int64 is the object of each detection or
    NOTHING; ``true_id`` (O,) int64 and ``true_xyxy_px`` (O, 4) float32 are the objects that are there, seen or not.
    """

    frames: tuple[DetectedFrame, ...]
    object_id: tuple[NDArray[np.int64], ...]
    true_id: tuple[NDArray[np.int64], ...]
    true_xyxy_px: tuple[NDArray[np.float32], ...]


def make_detections(*, objects: int, frames: int, seed: int) -> MadeDetections:
    """Detections of ``objects`` (at least 1) at a time over so many frames; equal arguments give equal arrays."""
    random = np.random.default_rng([seed, objects])
    crowd = _Crowd(objects, random)
    made: list[DetectedFrame] = []
    object_id: list[NDArray[np.int64]] = []
    true_id: list[NDArray[np.int64]] = []
    true_xyxy_px: list[NDArray[np.float32]] = []
    for index in range(frames):
        if index:
            crowd.move()
        boxes = crowd.xyxy_px
        detections, seen = _detect(boxes, crowd, random)
        made.append(DetectedFrame(index, index * PERIOD_NS, detections))
        object_id.append(seen)
        true_id.append(crowd.object_id.copy())
        true_xyxy_px.append(boxes.astype(np.float32))
    return MadeDetections(tuple(made), tuple(object_id), tuple(true_id), tuple(true_xyxy_px))


class _Crowd:
    """The objects that are there, a place in the arrays each; whoever leaves gives its place to a new one."""

    def __init__(self, count: int, random: np.random.Generator) -> None:
        self._random = random
        self._named = 0
        self.object_id = np.zeros(count, np.int64)
        self.center_px = np.zeros((count, 2))
        self.sides_px = np.zeros((count, 2))
        self.score = np.zeros(count)
        self.hidden_frames = np.zeros(count, np.int64)
        self._velocity_px_s = np.zeros((count, 2))
        self._life_s = np.zeros(count)
        self._begin(np.arange(count))

    @property
    def xyxy_px(self) -> NDArray[np.float64]:
        return np.concatenate([self.center_px - self.sides_px / 2, self.center_px + self.sides_px / 2], axis=1)

    def move(self) -> None:
        size_px = np.sqrt(self.sides_px.prod(axis=1, keepdims=True))
        wander = _SPEED_CHANGE_STD_SIZES * np.sqrt(_PERIOD_S) * size_px
        self._velocity_px_s += self._random.normal(size=self._velocity_px_s.shape) * wander
        self.center_px += self._velocity_px_s * _PERIOD_S
        self._life_s -= _PERIOD_S
        self.hidden_frames = np.maximum(self.hidden_frames - 1, 0)
        hides = (self._random.random(len(self.object_id)) < _HIDES) & (self.hidden_frames == 0)
        self.hidden_frames[hides] = self._random.integers(*_HIDDEN_FRAMES, size=np.count_nonzero(hides), endpoint=True)
        outside = ((self.center_px < 0) | (self.center_px > (WIDTH_PX, HEIGHT_PX))).any(axis=1)
        self._begin(np.flatnonzero(outside | (self._life_s <= 0)))

    def _begin(self, places: NDArray[np.intp]) -> None:
        count = len(places)
        random = self._random
        size_px = np.exp(random.uniform(*np.log(_SIZES_PX), size=(count, 1)))
        stretch = np.sqrt(random.uniform(*_ASPECTS, size=(count, 1)))
        self.object_id[places] = self._named + np.arange(count)
        self._named += count
        self.center_px[places] = random.uniform((0, 0), (WIDTH_PX, HEIGHT_PX), size=(count, 2))
        self.sides_px[places] = size_px * np.concatenate([stretch, 1 / stretch], axis=1)
        self.score[places] = random.uniform(*_SCORES, size=count)
        self.hidden_frames[places] = 0
        self._velocity_px_s[places] = random.normal(size=(count, 2)) * _SPEED_STD_SIZES * size_px
        self._life_s[places] = random.uniform(*_LIVES_S, size=count)


def _detect(
    true_xyxy_px: NDArray[np.float64], crowd: _Crowd, random: np.random.Generator
) -> tuple[Detections, NDArray[np.int64]]:
    """The detections of one frame by descending score, and the object of each."""
    count = len(true_xyxy_px)
    seen = np.flatnonzero((crowd.hidden_frames == 0) & (random.random(count) >= _MISSED))
    size_px = np.sqrt(crowd.sides_px[seen].prod(axis=1, keepdims=True))
    boxes = true_xyxy_px[seen] + random.normal(size=(len(seen), 4)) * _JITTER_STD_SIZES * size_px
    score = crowd.score[seen] + random.normal(size=len(seen)) * _SCORE_STD
    false_boxes = _false_boxes(random.poisson(_FALSE_SHARE * count), random)
    score = np.concatenate([score, random.uniform(*_FALSE_SCORES, size=len(false_boxes))])
    object_id = np.concatenate([crowd.object_id[seen], np.full(len(false_boxes), NOTHING)])
    order = np.argsort(-score, kind="stable")
    detections = Detections(
        xyxy_px=np.concatenate([boxes, false_boxes])[order].astype(np.float32),
        score=np.clip(score[order], 0.01, 0.99).astype(np.float32),
        class_id=np.zeros(len(order), np.int16),
    )
    return detections, object_id[order]


def _false_boxes(count: int, random: np.random.Generator) -> NDArray[np.float64]:
    center = random.uniform((0, 0), (WIDTH_PX, HEIGHT_PX), size=(count, 2))
    sides = random.uniform(*_SIZES_PX, size=(count, 2))
    return np.concatenate([center - sides / 2, center + sides / 2], axis=1)
