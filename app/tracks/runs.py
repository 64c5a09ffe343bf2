"""Tracks as runs of frames with about one score: what the timeline draws of 200,000 observations.

The frames of a track are taken four at a time, and each window has the mean of the detector's scores in it, cut to
tenths. Neighbouring windows of one tenth are one run. A run ends where the track is not seen, so gaps show frame by
frame.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

WINDOW_FRAMES = 4
FILLED = 10
"""The level of a run in which no observation has a score: the tracker filled all boxes in."""


def score_runs(
    track_id: NDArray[np.int64], frame_index: NDArray[np.int64], score: NDArray[np.float64]
) -> dict[int, list[int]]:
    """Runs by track: three numbers each, how many frames are skipped before it, its frames, and its level 0 to 10.

    The first run's skip counts from frame 0. The arrays are (N,), a row for each observation, sorted by track and
    frame; ``score`` is NaN where the box was filled in.
    """
    if len(track_id) == 0:
        return {}
    new_track = np.diff(track_id, prepend=track_id[0] - 1) != 0
    skipped = (np.diff(frame_index, prepend=frame_index[0]) != 1) | new_track
    first_row = np.flatnonzero(new_track)
    first_frame = frame_index[first_row][np.cumsum(new_track) - 1]
    window = (frame_index - first_frame) // WINDOW_FRAMES
    starts = np.flatnonzero(skipped | (np.diff(window, prepend=-1) != 0))
    level = _levels(score, starts)
    # Windows that go on where the one before ended, at its level, belong to its run.
    begins = skipped[starts] | (np.diff(level, prepend=-1) != 0)
    run_rows = starts[begins]
    last_rows = np.append(run_rows[1:], len(track_id)) - 1
    lengths = frame_index[last_rows] - frame_index[run_rows] + 1
    ends = frame_index[last_rows] + 1
    before = np.where(new_track[run_rows], 0, np.roll(ends, 1))
    numbers = np.stack([frame_index[run_rows] - before, lengths, level[begins]], axis=1)
    edges = np.flatnonzero(new_track[run_rows])[1:]
    tracks = track_id[first_row].tolist()
    return {track: rows.ravel().tolist() for track, rows in zip(tracks, np.split(numbers, edges), strict=True)}


def _levels(score: NDArray[np.float64], starts: NDArray[np.intp]) -> NDArray[np.int64]:
    """The level of each group of rows that begins at ``starts``."""
    scored = ~np.isnan(score)
    count = np.add.reduceat(scored.astype(np.int64), starts)
    total = np.add.reduceat(np.where(scored, score, 0.0), starts)
    mean = total / np.maximum(count, 1)
    # A score of exactly 0.3 is in the fourth tenth, whatever its binary form.
    tenths = np.clip(np.floor(mean * 10 + 1e-9), 0, FILLED - 1).astype(np.int64)
    return np.where(count > 0, tenths, FILLED)
