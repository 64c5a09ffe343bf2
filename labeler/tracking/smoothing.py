"""Where each object was at every moment of its track, by all that was seen before and after (Rauch-Tung-Striebel).

The filter is that of :mod:`labeler.tracking.box_filters`: all tracks that are there in a frame take a step together,
forward, and then together each is corrected by what came after it. What a detector is less sure of counts less: the
noise of a detected box grows as its score falls. Source: Rauch, Tung and Striebel, 1965.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from labeler.tracking.box_filters import POSITION, SPEED, SPEED_VARIANCE, VARIANCE, BoxFilters
from labeler.tracking.config import TrackingConfig

_Array = NDArray[np.float64]
_MIN_SIDE_PX = 1.0


@dataclass(frozen=True, eq=False)
class Paths:
    """Smooth paths of tracks: a row for each track and frame from its first to its last observation, by track, then
    frame.

    ``track``, ``frame`` (R,) int64 are numbers as in :class:`TrackBoxes`; ``position`` and ``speed`` (R, 4) are centre
    x, centre y, width and height in pixels (a second); ``variance`` and ``speed_variance`` (R, 2) are those of centre
    and sides, by what was seen before and after only where tracks are to be followed back, which needs them, else by
    what was seen before.
    """

    track: NDArray[np.int64]
    frame: NDArray[np.int64]
    position: _Array
    speed: _Array
    variance: _Array
    speed_variance: _Array

    def __getitem__(self, rows: NDArray[np.intp] | NDArray[np.bool_]) -> Paths:
        return Paths(
            self.track[rows],
            self.frame[rows],
            self.position[rows],
            self.speed[rows],
            self.variance[rows],
            self.speed_variance[rows],
        )

    @property
    def xyxy_px(self) -> _Array:
        """(R, 4) boxes; a side is never shorter than a pixel."""
        return self.boxes_after(np.zeros(len(self.track)))

    def boxes_after(self, dt_s: _Array) -> _Array:
        """(R, 4) boxes where each row would be ``dt_s`` (R,) seconds later (before, where negative)."""
        position = self.position + dt_s[:, None] * self.speed
        half = np.maximum(position[:, 2:], _MIN_SIDE_PX) / 2
        return np.concatenate([position[:, :2] - half, position[:, :2] + half], axis=1)

    def with_tracks_of(self, other: Paths) -> Paths:
        """These paths and those of other tracks, which are numbered between and around them."""
        track, frame = np.concatenate([self.track, other.track]), np.concatenate([self.frame, other.frame])
        order = np.argsort(track, kind="stable")
        return Paths(
            track[order],
            frame[order],
            np.concatenate([self.position, other.position])[order],
            np.concatenate([self.speed, other.speed])[order],
            np.concatenate([self.variance, other.variance])[order],
            np.concatenate([self.speed_variance, other.speed_variance])[order],
        )

    def ends(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Rows of the first and of the last frame of each track."""
        first = np.flatnonzero(np.diff(self.track, prepend=-1))
        return first, np.append(first[1:], len(self.track))[: len(first)] - 1


@dataclass(frozen=True, eq=False)
class TrackBoxes:
    """Boxes of tracks, at most one for each track and frame, by ``track``, then ``frame`` (N,) int64, numbers from 0.
    ``xyxy_px`` (N, 4) float64; ``noise`` (N,) float64 is how much farther off a box is than one that the detector is
    sure of (a factor on the standard deviation)."""

    track: NDArray[np.int64]
    frame: NDArray[np.int64]
    xyxy_px: _Array
    noise: _Array

    def __getitem__(self, rows: NDArray[np.bool_]) -> TrackBoxes:
        return TrackBoxes(self.track[rows], self.frame[rows], self.xyxy_px[rows], self.noise[rows])


def smooth(boxes: TrackBoxes, time_s: _Array, config: TrackingConfig) -> Paths:
    """The paths of all tracks; ``time_s`` (F,) is the time of each frame, never falling."""
    if len(boxes.track) == 0:
        none = np.zeros(0, np.int64)
        return Paths(none, none, *np.zeros((2, 0, 4)), *np.zeros((2, 0, 2)))
    plan = _Plan.of(boxes, len(time_s))
    filtered, predicted = _filter(plan, boxes, time_s, config)
    _smooth_back(plan, filtered, predicted, time_s, with_variances=config.follow_back)
    of_path = filtered.take(plan.row_of_path, axis=1)
    return Paths(
        track=plan.track,
        frame=plan.frame,
        position=of_path[POSITION].T,
        speed=of_path[SPEED].T,
        variance=of_path[VARIANCE].T,
        speed_variance=of_path[SPEED_VARIANCE].T,
    )


@dataclass(frozen=True, eq=False)
class _Plan:
    """Where everything lies. A row is a track in a frame from its first box to its last, R in all.

    ``track`` and ``frame`` (R,) are those of the paths: by track, then frame. The filters work on rows by frame, then
    in the order in which tracks begin, so those that begin come last and those that go on keep their order:
    ``row_of_path`` (R,) leads from paths to them, ``start`` (F + 1,) is where each frame's rows begin, ``goes_on`` (R,)
    whether the track is there in the next frame too, ``new`` (F,) how many tracks begin. ``box_row`` (N,) is the row of
    each box.
    """

    track: NDArray[np.int64]
    frame: NDArray[np.int64]
    row_of_path: NDArray[np.intp]
    start: NDArray[np.intp]
    goes_on: NDArray[np.bool_]
    new: NDArray[np.intp]
    box_row: NDArray[np.intp]

    @staticmethod
    def of(boxes: TrackBoxes, frame_count: int) -> _Plan:
        starts = np.flatnonzero(np.diff(boxes.track, prepend=-1))
        stops = np.append(starts[1:], len(boxes.track))
        first, last = boxes.frame[starts], boxes.frame[stops - 1]
        length = last - first + 1
        path_start = np.cumsum(length) - length
        place = np.repeat(np.arange(len(starts)), length)
        frame = np.arange(len(place)) - path_start[place] + first[place]
        by_frame = np.lexsort((place, first[place], frame))
        row_of_path = np.empty(len(place), np.intp)
        row_of_path[by_frame] = np.arange(len(place))
        own_place = np.repeat(np.arange(len(starts)), stops - starts)
        return _Plan(
            track=boxes.track[starts][place],
            frame=frame,
            row_of_path=row_of_path,
            start=np.searchsorted(frame[by_frame], np.arange(frame_count + 1)),
            goes_on=(frame < last[place])[by_frame],
            new=np.bincount(first, minlength=frame_count),
            box_row=row_of_path[path_start[own_place] + boxes.frame - first[own_place]],
        )


def _filter(plan: _Plan, boxes: TrackBoxes, time_s: _Array, config: TrackingConfig) -> tuple[_Array, _Array]:
    """(14, R) states of the filters after the box of each row, and (14, R) as predicted before it."""
    filters = BoxFilters(
        replace(
            config,
            measurement_std_sizes=config.smooth_measurement_std_sizes,
            speed_change_std_sizes=config.smooth_speed_change_std_sizes,
            growth_ratio=config.smooth_growth_ratio,
        )
    )
    order = np.argsort(plan.box_row, kind="stable")
    row, xyxy_px, noise = plan.box_row[order], boxes.xyxy_px[order], boxes.noise[order]
    start, new = plan.start.tolist(), plan.new.tolist()
    box_start = np.searchsorted(row, plan.start).tolist()
    steps_s = np.diff(time_s, prepend=time_s[:1]).round(12).tolist()  # an even rate gives equal steps
    filtered, predicted = np.empty((2, 14, len(plan.track)))
    for frame, dt_s in enumerate(steps_s):
        begin, end = start[frame], start[frame + 1]
        if len(filters):
            previous = slice(start[frame - 1], begin)
            if len(filters) != end - begin - new[frame]:
                filters.keep(plan.goes_on[previous])
            filters.predict(dt_s)
        box, first_box, last_box = box_start[frame], box_start[frame + 1] - new[frame], box_start[frame + 1]
        if new[frame]:
            filters.add(xyxy_px[first_box:last_box], noise[first_box:last_box])
        predicted[:, begin:end] = filters.state
        if first_box > box:
            filters.update(row[box:first_box] - begin, xyxy_px[box:first_box], noise[box:first_box])
        filtered[:, begin:end] = filters.state
    return filtered, predicted


def _smooth_back(plan: _Plan, states: _Array, predicted: _Array, time_s: _Array, *, with_variances: bool) -> None:
    """Correct the states (14, R) of each frame by those of the next, backward in time and in place.

    How much each follows the next is known at once for all rows, because it depends on the covariances only."""
    going = np.flatnonzero(plan.goes_on)
    frame = np.repeat(np.arange(len(time_s)), np.diff(plan.start))[going]
    coming = np.arange(len(going)) + np.cumsum(plan.new)[frame]  # rows of a frame: who goes on, then who begins
    gain = _gains(states[8:, going], predicted[8:, coming], np.diff(time_s)[frame])
    start = np.searchsorted(going, plan.start).tolist()
    for begin, end in zip(start[-2::-1], start[:0:-1], strict=True):
        if begin == end:
            continue
        rows, of_gain = going[begin:end], gain[..., begin:end]
        later = slice(int(coming[begin]), int(coming[end - 1]) + 1)
        surprise = states[:8, later] - predicted[:8, later]
        states[:8, rows] += (of_gain[:, :, :, None] * surprise.reshape(1, 2, 2, 2, -1)).sum(axis=1).reshape(8, -1)
        if with_variances:
            x, y, z = (states[8:, later] - predicted[8:, later]).reshape(3, 2, -1)
            change = np.einsum("ipcn,pqcn,jqcn->ijcn", of_gain, np.array([[x, y], [y, z]]), of_gain)
            states[8:, rows] += change[[0, 0, 1], [0, 1, 1]].reshape(6, -1)


def _gains(filtered: _Array, predicted: _Array, dt_s: _Array) -> _Array:
    """(2, 2, 2, N): how position and speed (first axis) follow a surprise in position and speed (second) of the next
    frame, for centre and sides. Covariances (6, N) after a frame and predicted for the next, ``dt_s`` (N,) later."""
    a, b, c = filtered.reshape(3, 2, -1)
    p, q, r = predicted.reshape(3, 2, -1)
    u, v = a + dt_s * b, b + dt_s * c
    determinant = p * r - q * q
    scale = np.zeros_like(determinant)
    np.divide(1.0, determinant, out=scale, where=determinant > 1e-12 * p * r)
    to_position = (u * r - b * q) * scale, (b * p - u * q) * scale
    to_speed = (v * r - c * q) * scale, (c * p - v * q) * scale
    return np.array([to_position, to_speed])
