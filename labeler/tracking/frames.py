"""What every tracker asks of the frames that it is given."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from labeler.tracking.errors import TrackingError
from labeler.tracking.types import DetectedFrame

NS_PER_S = 1_000_000_000
FRAMES_READ_AT_ONCE = 64


def check_order(previous: DetectedFrame | None, frame: DetectedFrame) -> None:
    """TrackingError where ``frame`` does not come after ``previous``; at the same time is allowed."""
    if previous is None:
        return
    if frame.frame_index <= previous.frame_index or frame.timestamp_ns < previous.timestamp_ns:
        raise TrackingError(
            f"Frame {frame.frame_index} at {frame.timestamp_ns} ns came after frame {previous.frame_index} at "
            f"{previous.timestamp_ns} ns. A tracker needs the frames of one camera in order of time: sort them first."
        )


class Usable(NamedTuple):
    """The detections of a frame that can be used: their ``rows`` (M,) in it, boxes (M, 4), scores, classes and groups
    of classes."""

    rows: NDArray[np.intp]
    xyxy_px: NDArray[np.float64]
    score: NDArray[np.float32]
    class_id: NDArray[np.int16]
    group: NDArray[np.int64]
    broken_count: int
    """How many others are not sound."""


def with_usable_detections(
    frames: Iterable[DetectedFrame], *, min_score: float, class_groups: NDArray[np.int64]
) -> Iterator[tuple[DetectedFrame, Usable]]:
    """Each frame with its sound detections of at least that score.

    Frames are read ``FRAMES_READ_AT_ONCE``, which costs little more than one. TrackingError where they come out of
    order, or a detection is of a class without a group."""
    source = iter(frames)
    previous: DetectedFrame | None = None
    while some := list(islice(source, FRAMES_READ_AT_ONCE)):
        for frame in some:
            check_order(previous, frame)
            previous = frame
        yield from zip(some, _usable_of(some, min_score, class_groups), strict=True)


def _usable_of(frames: Sequence[DetectedFrame], min_score: float, class_groups: NDArray[np.int64]) -> Iterator[Usable]:
    found = [frame.detections for frame in frames]
    xyxy_px = np.concatenate([one.xyxy_px for one in found]).astype(np.float64)
    score = np.concatenate([one.score for one in found])
    sound = _are_sound(xyxy_px, score)
    with np.errstate(invalid="ignore"):
        kept = np.flatnonzero(sound & (score >= min_score))
    counts = np.array([len(one) for one in found])
    number_of = np.repeat(np.arange(len(frames)), counts)
    number = number_of[kept]
    class_id = np.concatenate([one.class_id for one in found])[kept]
    group = _groups_of(class_id, frames, number, class_groups)
    rows, xyxy_px, score = kept - (np.cumsum(counts) - counts)[number], xyxy_px[kept], score[kept]
    broken_count = np.bincount(number_of[~sound], minlength=len(frames)).tolist()
    start = 0
    for stop, broken in zip(np.cumsum(np.bincount(number, minlength=len(frames))).tolist(), broken_count, strict=True):
        part = slice(start, stop)
        yield Usable(rows[part], xyxy_px[part], score[part], class_id[part], group[part], broken)
        start = stop


def _are_sound(xyxy_px: NDArray[np.float64], score: NDArray[np.float32]) -> NDArray[np.bool_]:
    """(N,) whether score and box are finite, and the box has an area."""
    x1, y1, x2, y2 = xyxy_px.T
    with np.errstate(invalid="ignore"):
        return np.isfinite(x1 + y1 + x2 + y2 + score) & (x2 > x1) & (y2 > y1)


def _groups_of(
    class_id: NDArray[np.int16],
    frames: Sequence[DetectedFrame],
    number: NDArray[np.intp],
    class_groups: NDArray[np.int64],
) -> NDArray[np.int64]:
    """(N,) group of each class; ``number`` (N,) is the frame that it is of."""
    known = (class_id >= 0) & (class_id < len(class_groups))
    if not known.all():
        first = int(np.flatnonzero(~known)[0])
        frame = frames[int(number[first])]
        raise TrackingError(
            f"Frame {frame.frame_index} has a detection of class {class_id[first]}, but the tracker "
            f"knows the groups of {len(class_groups)} classes only. Give it a group for every class of the detector."
        )
    return class_groups[class_id]
