"""Fragments of one object that an occlusion cut apart: where one ends, another begins as if it had gone on.

The two paths are carried on to the middle of the gap, one forward, one backward, and must meet there: their boxes have
to overlap, which asks for the same place, speed and size. Each end takes one beginning, those that meet best together.
Where the camera's motion is known, both are seen as from the frame that is next to the middle.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from labeler.tracking.camera_motion import TracksMotion
from labeler.tracking.config import TrackingConfig
from labeler.tracking.pairing import Candidates, pair_off, ranges_of
from labeler.tracking.smoothing import Paths


def find_continuations(
    paths: Paths,
    group: NDArray[np.int64],
    may_join: NDArray[np.bool_],
    time_s: NDArray[np.float64],
    config: TrackingConfig,
    motion: TracksMotion | None = None,
) -> NDArray[np.int64]:
    """(T,) for each track the one that it goes on from, itself where none; chains end at the earliest fragment.

    ``group`` (T,) is the class group of each track, only tracks of one group are one object; ``may_join`` (T,) is
    whether a track takes part at all.
    """
    first, last = paths.ends()
    continued = np.arange(len(first))
    begin_s, end_s = time_s[paths.frame[first]], time_s[paths.frame[last]]
    joining = np.flatnonzero(may_join)
    by_begin = joining[np.argsort(begin_s[joining], kind="stable")]
    low = np.searchsorted(begin_s[by_begin], end_s[joining], side="right")
    high = np.searchsorted(begin_s[by_begin], end_s[joining] + config.max_stitch_s, side="right")
    found: list[Candidates] = []
    for row, place in ranges_of(low, high):
        a, b = joining[row], by_begin[place]
        same = group[a] == group[b]
        a, b = a[same], b[same]
        half_gap_s = (begin_s[b] - end_s[a]) / 2
        ends, begins = paths[last[a]], paths[first[b]]
        forward_px = backward_px = None
        if motion is not None:
            middle = np.searchsorted(time_s, (begin_s[b] + end_s[a]) / 2)
            forward_px = motion.between(ends.position.T, ends.track, ends.frame, middle)
            backward_px = motion.between(begins.position.T, begins.track, begins.frame, middle)
        meeting = overlap_of_rows(
            ends.boxes_after(half_gap_s, forward_px), begins.boxes_after(-half_gap_s, backward_px)
        )
        close = meeting >= config.min_iou_stitch
        found.append(Candidates(a[close], b[close], meeting[close]))
    if not found:
        return continued
    ends, beginnings = pair_off(Candidates.of_parts(found), a_count=len(first), b_count=len(first))
    order = np.argsort(begin_s[beginnings], kind="stable")
    for end, beginning in zip(ends[order].tolist(), beginnings[order].tolist(), strict=True):
        continued[beginning] = continued[end]
    return continued


def overlap_of_rows(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N,) IoU of the boxes (N, 4) and (N, 4) in the same row; 0 where both are empty."""
    sides = np.clip(np.minimum(a[:, 2:], b[:, 2:]) - np.maximum(a[:, :2], b[:, :2]), 0, None)
    shared = sides[:, 0] * sides[:, 1]
    union = np.prod(a[:, 2:] - a[:, :2], axis=1) + np.prod(b[:, 2:] - b[:, :2], axis=1) - shared
    return np.divide(shared, union, out=np.zeros(len(a)), where=union > 0)
