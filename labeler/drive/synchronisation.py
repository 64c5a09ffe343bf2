"""Puts the readings of cameras and LiDAR that belong to one moment into one frame.

The clock is the LiDAR's: each sweep is a frame, and an image belongs to the sweep nearest in time, when that is within
half a period (the median gap of the clock). Where the LiDAR is silent for more than 1.5 periods, the times of the
reference camera fill the gap at about the LiDAR's period, then those of the other cameras, so that no stretch of images
is lost. Without a LiDAR the reference camera is the clock. All of it works on whole arrays of times.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from labeler.drive.listing import counted
from labeler.drive.types import Frame, ImageFile, SweepFile

DEFAULT_PERIOD_NS = 100_000_000
"""The period where the clock has one reading only: 10 Hz, the usual rate of a turning LiDAR."""

_LONGEST_REGULAR_GAP = 1.5
"""In periods. A longer gap means that readings are missing."""

_Times = NDArray[np.int64]


def synchronise(
    images: Mapping[str, Sequence[ImageFile]], sweeps: Sequence[SweepFile]
) -> tuple[tuple[Frame, ...], tuple[str, ...]]:
    """Frames in order of time, and warnings. Images by camera, and sweeps, must be in strictly increasing time.

    Each image and each sweep is in at most one frame. Moments without any image make no frame; a warning counts the
    sweeps that are lost so."""
    image_times = {camera: _times_of(files) for camera, files in images.items() if files}
    sweep_times = _times_of(sweeps)
    clock, period_ns = _clock(image_times, sweep_times)
    chosen = {camera: _nearest_images(clock, times, period_ns) for camera, times in image_times.items()}
    sweep_of = dict(zip(sweep_times.tolist(), sweeps, strict=True))
    images_at: list[dict[str, ImageFile]] = [{} for _ in clock]
    for camera, (moments, rows) in chosen.items():
        files = images[camera]
        for moment, row in zip(moments.tolist(), rows.tolist(), strict=True):
            images_at[moment][camera] = files[row]
    kept = [(time_ns, at) for time_ns, at in zip(clock.tolist(), images_at, strict=True) if at]
    frames = tuple(Frame(index, time_ns, at, sweep_of.get(time_ns)) for index, (time_ns, at) in enumerate(kept))
    lost = len(sweeps) - sum(frame.sweep is not None for frame in frames)
    told = f"Left out {counted(lost, 'LiDAR sweep')} that no image is near to ({lost:,} of {len(sweeps):,})."
    return frames, (told,) if lost else ()


def reference_order(image_counts: Mapping[str, int]) -> list[str]:
    """Cameras in the order in which they serve as the clock: most images first, then one whose name says front, then
    by name.
    """
    return sorted(image_counts, key=lambda camera: (-image_counts[camera], "front" not in camera.lower(), camera))


def _times_of(files: Sequence[ImageFile] | Sequence[SweepFile]) -> _Times:
    return np.array([file.timestamp_ns for file in files], dtype=np.int64)


def _clock(image_times: Mapping[str, _Times], sweep_times: _Times) -> tuple[_Times, int]:
    """The times of all frames, and the period in nanoseconds."""
    order = reference_order({camera: len(times) for camera, times in image_times.items()})
    clock = sweep_times
    if not len(clock) and order:
        clock, order = image_times[order[0]], order[1:]
    period_ns = _period_of(clock)
    for camera in order:
        clock = np.union1d(clock, _fill(clock, image_times[camera], period_ns))
    return clock, period_ns


def _period_of(clock: _Times) -> int:
    return max(1, int(np.median(np.diff(clock)))) if len(clock) > 1 else DEFAULT_PERIOD_NS


def _fill(clock: _Times, times: _Times, period_ns: int) -> _Times:
    """Those of ``times`` that stand nearest to an even grid over the stretches in which the clock is silent.

    Only the grid points near to a time are ever looked at, for a clock may be off by years."""
    right = np.searchsorted(clock, times, side="right")
    start = clock[np.maximum(right - 1, 0)]
    gap_ns = clock[np.minimum(right, len(clock) - 1)] - start
    inside = (right > 0) & (right < len(clock))
    parts = np.maximum(2, (gap_ns + period_ns // 2) // period_ns)
    step_ns = np.maximum(1, np.where(inside, gap_ns // parts, period_ns))
    slot = (times - start + step_ns // 2) // step_ns
    silent = inside & (gap_ns > _LONGEST_REGULAR_GAP * period_ns) & (slot >= 1) & (slot < parts)
    outside = ~inside & (2 * np.abs(times - start) > period_ns)
    rows = np.flatnonzero(silent | outside)
    distance_ns = np.abs(times - start - slot * step_ns)
    best = rows[np.lexsort((distance_ns[rows], slot[rows], right[rows]))]
    _, first = np.unique(np.stack([right[best], slot[best]]), axis=1, return_index=True)
    return times[best[first]]


def _nearest(sorted_times: _Times, wanted: _Times) -> NDArray[np.intp]:
    """The position of the time nearest to each wanted one; the earlier of two that are equally near."""
    right = np.minimum(np.searchsorted(sorted_times, wanted), len(sorted_times) - 1)
    left = np.maximum(right - 1, 0)
    return np.where(wanted - sorted_times[left] <= sorted_times[right] - wanted, left, right)


def _nearest_images(clock: _Times, times: _Times, period_ns: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """(moments, rows): which image serves which moment of the clock, at most one each."""
    moments = _nearest(clock, times)
    distances_ns = np.abs(times - clock[moments])
    near = np.flatnonzero(2 * distances_ns <= _local_period(clock, times, period_ns))
    order = near[np.lexsort((distances_ns[near], moments[near]))]
    _, first = np.unique(moments[order], return_index=True)
    rows = order[first]
    return moments[rows], rows


def _local_period(clock: _Times, times: _Times, period_ns: int) -> _Times:
    """The period at each time: that of the clock, or the gap it stands in where that is longer by jitter only.

    Otherwise images of a camera that fires half a period after the LiDAR would be lost at random."""
    if len(clock) < 2:
        return np.full(len(times), period_ns, dtype=np.int64)
    left = np.clip(np.searchsorted(clock, times) - 1, 0, len(clock) - 2)
    gaps_ns = clock[left + 1] - clock[left]
    inside = (times >= clock[0]) & (times <= clock[-1]) & (gaps_ns <= _LONGEST_REGULAR_GAP * period_ns)
    return np.where(inside, np.maximum(gaps_ns, period_ns), period_ns)
