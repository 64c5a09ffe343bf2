"""Where each object was at every moment of its track, by all that was seen before and after (Rauch-Tung-Striebel).

The filter is that of :mod:`labeler.tracking.box_filters`. All tracks begin together, whenever that was, and step from
frame to frame together, forward, and then back, where each state is corrected by what came after it: there are as many
steps as the longest track has frames. What a detector is less sure of counts less: the noise of a detected box grows as
its score falls. Source: Rauch, Tung and Striebel, 1965.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from labeler.tracking.box_filters import POSITION, SPEED, SPEED_VARIANCE, VARIANCE, BoxFilters
from labeler.tracking.camera_motion import TracksMotion
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

    def boxes_after(self, dt_s: _Array, moved_px: _Array | None = None) -> _Array:
        """(R, 4) boxes where each row would be ``dt_s`` (R,) seconds later (before, where negative); the camera moves
        them by ``moved_px`` (4, R) until then."""
        position = self.position + dt_s[:, None] * self.speed
        if moved_px is not None:
            position += moved_px.T
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


def smooth(boxes: TrackBoxes, time_s: _Array, config: TrackingConfig, motion: TracksMotion | None = None) -> Paths:
    """The paths of all tracks; ``time_s`` (F,) is the time of each frame, never falling. What the camera's ``motion``
    does to them is known beforehand, where it is given; speeds are what is left then."""
    if len(boxes.track) == 0:
        none = np.zeros(0, np.int64)
        return Paths(none, none, *np.zeros((2, 0, 4)), *np.zeros((2, 0, 2)))
    plan = _Plan.of(boxes, time_s)
    filtered, predicted = _filter(plan, boxes, config, motion)
    _smooth_back(plan, filtered, predicted, with_variances=config.follow_back)
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

    ``track`` and ``frame`` (R,) are those of the paths: by track, then frame. The filters work on rows by step, which
    is how many frames the track has been there for, then by track, the longest first: so those that go on are the first
    of each step. ``row_of_path`` (R,) leads from paths to these rows, ``start`` (S + 1,) is where each step's begin,
    ``dt_s`` (R,) the time since the track's row of the step before, 0 in the first. ``box_row`` (N,) is the row of each
    box.
    """

    track: NDArray[np.int64]
    frame: NDArray[np.int64]
    row_of_path: NDArray[np.intp]
    start: NDArray[np.intp]
    dt_s: _Array
    box_row: NDArray[np.intp]

    @staticmethod
    def of(boxes: TrackBoxes, time_s: _Array) -> _Plan:
        starts = np.flatnonzero(np.diff(boxes.track, prepend=-1))
        stops = np.append(starts[1:], len(boxes.track))
        first = boxes.frame[starts]
        length = boxes.frame[stops - 1] - first + 1
        place_of = np.empty(len(starts), np.intp)
        place_of[np.argsort(-length, kind="stable")] = np.arange(len(starts))
        there = np.cumsum(np.bincount(length)[::-1])[::-1][1:]  # how many tracks are that long or longer
        start = np.concatenate([np.zeros(1, np.intp), np.cumsum(there)])
        number = np.repeat(np.arange(len(starts)), length)
        step = np.arange(len(number)) - np.repeat(np.cumsum(length) - length, length)
        frame = first[number] + step
        row_of_path = start[step] + place_of[number]
        steps_s = np.diff(time_s, prepend=time_s[:1]).round(12)  # an even rate gives equal steps
        dt_s = np.empty(len(number))
        dt_s[row_of_path] = np.where(step > 0, steps_s[frame], 0.0)
        own = np.repeat(np.arange(len(starts)), stops - starts)
        return _Plan(
            track=boxes.track[starts][number],
            frame=frame,
            row_of_path=row_of_path,
            start=start,
            dt_s=dt_s,
            box_row=start[boxes.frame - first[own]] + place_of[own],
        )


def _filter(
    plan: _Plan, boxes: TrackBoxes, config: TrackingConfig, motion: TracksMotion | None
) -> tuple[_Array, _Array]:
    """(14, R) states of the filters after the box of each row, and (14, R) as predicted before it."""
    filters = BoxFilters(
        replace(
            config,
            measurement_std_sizes=config.smooth_measurement_std_sizes,
            speed_change_std_sizes=config.smooth_speed_change_std_sizes,
            growth_ratio=config.smooth_growth_ratio,
        )
    )
    order = np.argsort(plan.box_row)
    row = plan.box_row[order]
    measured = filters.measure(boxes.xyxy_px[order], boxes.noise[order])
    box_start = np.searchsorted(row, plan.start).tolist()
    least, most = np.minimum.reduceat(plan.dt_s, plan.start[:-1]), np.maximum.reduceat(plan.dt_s, plan.start[:-1])
    filtered, predicted = np.empty((2, 14, len(plan.track)))
    path_of_row = np.argsort(plan.row_of_path)
    into, height_m = None, np.zeros(0)
    if motion is not None:
        into, height_m = motion.into_frames(plan.track[path_of_row], plan.frame[path_of_row])
    start = plan.start.tolist()
    filters.add(measured[: start[1]])  # a track begins with a box
    predicted[:, : start[1]] = filtered[:, : start[1]] = filters.state
    for step, is_even in enumerate((least == most)[1:].tolist(), start=1):
        begin, end = start[step], start[step + 1]
        filters.keep_first(end - begin)
        dt_s = plan.dt_s[begin:end]
        if into is not None:
            filters.move(into[begin:end].displacements(filters.state[POSITION], height_m[begin:end]))
        if is_even:
            filters.predict(float(dt_s[0]))
        else:
            filters.predict_each(dt_s)
        predicted[:, begin:end] = filters.state
        of_step = slice(box_start[step], box_start[step + 1])
        has_all = of_step.stop - of_step.start == end - begin
        filters.update(slice(None) if has_all else row[of_step] - begin, measured[of_step])
        filtered[:, begin:end] = filters.state
    return filtered, predicted


def _smooth_back(plan: _Plan, states: _Array, predicted: _Array, *, with_variances: bool) -> None:
    """Correct the states (14, R) of each step by those of the next, the last first and in place.

    How much each follows the next is known at once for all rows, because it depends on the covariances only."""
    second = int(plan.start[1])
    there = np.diff(plan.start)[1:]
    going = np.arange(second, len(plan.track)) - np.repeat(np.diff(plan.start)[:-1], there)  # a step before each row
    gain = _gains(states[8:, going], predicted[8:, second:], plan.dt_s[second:])
    start = plan.start.tolist()
    for step in range(len(start) - 2, 0, -1):
        begin, end = start[step], start[step + 1]
        rows, later = slice(start[step - 1], start[step - 1] + end - begin), slice(begin, end)
        of_gain = gain[..., begin - second : end - second]
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
