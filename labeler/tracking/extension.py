"""Follow each track back in time from its beginning: what was too unsure to begin a track may still belong to one.

The same filter and rules as forward, with the clock running backward and the smooth path's first state to begin with.
Only detections that no track has can be taken, and they must fit as well as a weak detection has to.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from labeler.tracking.box_filters import POSITION, BoxFilters
from labeler.tracking.camera_motion import TracksMotion
from labeler.tracking.config import TrackingConfig
from labeler.tracking.pairing import overlapping, pair_off
from labeler.tracking.smoothing import Paths
from labeler.tracking.window import NO_TRACK, Window


def extend_back(
    window: Window,
    paths: Paths,
    group: NDArray[np.int64],
    config: TrackingConfig,
    *,
    first_frame: int,
    motion: TracksMotion | None = None,
) -> tuple[NDArray[np.intp], NDArray[np.int64]]:
    """Detections (rows of the window) and the number of the track that takes each, back to ``first_frame`` at most.

    ``group`` (T,) is the class group of each track."""
    is_free = window.track_id == NO_TRACK
    found: list[NDArray[np.intp]] = []
    found_track: list[NDArray[np.int64]] = []
    first, _ = paths.ends()
    order = np.argsort(paths.frame[first], kind="stable")
    beginning = first[order]
    begins = np.searchsorted(paths.frame[beginning], np.arange(len(window.time_s) + 1))
    filters = BoxFilters(config)
    follows = np.zeros(0, np.int64)
    seen_s = np.zeros(0)
    for frame in range(len(window.time_s) - 1, first_frame - 1, -1):
        now_s = window.time_s[frame]
        if len(follows):
            staying = seen_s - now_s <= config.max_coast_s
            filters.keep(staying)
            follows, seen_s = follows[staying], seen_s[staying]
            if motion is not None:
                here = np.full(len(follows), frame)
                filters.move(motion.between(filters.state[POSITION], follows, here + 1, here))
            filters.predict(window.time_s[frame + 1] - now_s)
            begin = int(window.start[frame])
            free = begin + np.flatnonzero(is_free[begin : int(window.start[frame + 1])])
            corners = np.ascontiguousarray(window.xyxy_px[free].T)
            near = overlapping(*filters.corners_px(), corners[:2], corners[2:], min_iou=config.min_iou_back)
            near = near[group[follows[near.a]] == window.group[free[near.b]]]
            rows, taken = pair_off(near, a_count=len(follows), b_count=len(free))
            filters.update(rows, filters.measure(window.xyxy_px[free[taken]]))
            seen_s[rows] = now_s
            found.append(free[taken])
            found_track.append(follows[rows])
        new = beginning[begins[frame] : begins[frame + 1]]
        if len(new):
            state = paths[new]
            filters.resume(state.position, -state.speed, state.variance, state.speed_variance)
            follows = np.concatenate([follows, paths.track[new]])
            seen_s = np.concatenate([seen_s, np.full(len(new), now_s)])
    return np.concatenate([np.zeros(0, np.intp), *found]), np.concatenate([np.zeros(0, np.int64), *found_track])
