"""A stretch of one camera's frames with the track of every detection, as flat arrays that offline passes work on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from labeler.tracking.frames import NS_PER_S, Usable
from labeler.tracking.types import DetectedFrame

NO_TRACK = -1


@dataclass(frozen=True, eq=False)
class TrackedFrame:
    """A frame, its usable detections, the track of each (M,) or NO_TRACK, and whether it is left over from the sure
    tracks."""

    frame: DetectedFrame
    usable: Usable
    track_id: NDArray[np.int32]
    is_weak: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Window:
    """F frames and their D usable detections, in order of frames.

    ``timestamp_ns`` (F,) are their times, ``time_s`` (F,) counts from the first frame, ``frame_index`` (F,) is each
    frame's in the drive, ``start`` (F + 1,) is where each frame's detections begin. Of each detection: ``frame`` (D,)
    in the window, ``row`` (D,) in its frame, ``xyxy_px`` (D, 4) float64, ``score`` (D,), ``class_id`` (D,), ``group``
    (D,), ``track_id`` (D,) or NO_TRACK, and ``is_weak`` (D,): left over from the sure tracks.
    """

    timestamp_ns: NDArray[np.int64]
    time_s: NDArray[np.float64]
    frame_index: NDArray[np.int32]
    start: NDArray[np.intp]
    frame: NDArray[np.int64]
    row: NDArray[np.intp]
    xyxy_px: NDArray[np.float64]
    score: NDArray[np.float64]
    class_id: NDArray[np.int16]
    group: NDArray[np.int64]
    track_id: NDArray[np.int32]
    is_weak: NDArray[np.bool_]

    @staticmethod
    def of(frames: Sequence[TrackedFrame]) -> Window:
        counts = np.array([len(one.usable.rows) for one in frames], np.intp)
        timestamp_ns = np.array([one.frame.timestamp_ns for one in frames], np.int64)
        return Window(
            timestamp_ns=timestamp_ns,
            time_s=(timestamp_ns - timestamp_ns[0]) / NS_PER_S,
            frame_index=np.array([one.frame.frame_index for one in frames], np.int32),
            start=np.concatenate([np.zeros(1, np.intp), np.cumsum(counts)]),
            frame=np.repeat(np.arange(len(frames)), counts),
            row=np.concatenate([one.usable.rows for one in frames]),
            xyxy_px=np.concatenate([one.usable.xyxy_px for one in frames]),
            score=np.concatenate([one.usable.score for one in frames]).astype(np.float64),
            class_id=np.concatenate([one.usable.class_id for one in frames]),
            group=np.concatenate([one.usable.group for one in frames]),
            track_id=np.concatenate([one.track_id for one in frames]),
            is_weak=np.concatenate([one.is_weak for one in frames]),
        )

    def with_tracks(self, track_id: NDArray[np.int32]) -> Window:
        return replace(self, track_id=track_id)
