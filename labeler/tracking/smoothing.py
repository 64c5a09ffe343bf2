"""Where each object was at every moment of its track, by all that was seen before and after (Rauch-Tung-Striebel).

The filter is that of :mod:`labeler.tracking.box_filters`, here with all tracks side by side, each from its own first
frame on, so that one step in time is a fixed number of array operations for all of them. What a detector is less sure
of counts less: the noise of a detected box grows as its score falls. Source: Rauch, Tung and Striebel, 1965.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.tracking.config import TrackingConfig

_Array = NDArray[np.float64]
_MIN_SIDE_PX = 1.0
_CELLS_AT_ONCE = 100_000


@dataclass(frozen=True, eq=False)
class Paths:
    """Smooth paths of tracks: a row for each track and frame from its first to its last observation, by track, then
    frame.

    ``track``, ``frame`` (R,) int64 are numbers as in :class:`TrackBoxes`; ``position`` and ``speed`` (R, 4) are centre
    x, centre y, width and height in pixels (a second); ``variance`` and ``speed_variance`` (R, 2) are those of centre
    and sides.
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

    def ends(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Rows of the first and of the last frame of each track."""
        first = np.flatnonzero(np.diff(self.track, prepend=-1))
        return first, np.append(first[1:], len(self.track))[: len(first)] - 1


@dataclass(frozen=True, eq=False)
class TrackBoxes:
    """Boxes of tracks, at most one for each track and frame, by ``track``, then ``frame`` (N,) int64, both counted from
    0. ``xyxy_px`` (N, 4) float64; ``noise`` (N,) float64 is how much farther off a box is than one that the detector is
    sure of (a factor on the standard deviation)."""

    track: NDArray[np.int64]
    frame: NDArray[np.int64]
    xyxy_px: _Array
    noise: _Array


def smooth(boxes: TrackBoxes, time_s: _Array, config: TrackingConfig) -> Paths:
    """The paths of all tracks; ``time_s`` (F,) is the time of each frame, never falling."""
    parts = [_smooth_block(block, time_s, config) for block in _blocks(boxes)]
    if not parts:
        none = np.zeros(0, np.int64)
        return Paths(none, none, *np.zeros((2, 0, 4)), *np.zeros((2, 0, 2)))
    joined = Paths(
        track=np.concatenate([part.track for part in parts]),
        frame=np.concatenate([part.frame for part in parts]),
        position=np.concatenate([part.position for part in parts]),
        speed=np.concatenate([part.speed for part in parts]),
        variance=np.concatenate([part.variance for part in parts]),
        speed_variance=np.concatenate([part.speed_variance for part in parts]),
    )
    return joined[np.lexsort((joined.frame, joined.track))]


def _blocks(boxes: TrackBoxes) -> Iterator[TrackBoxes]:
    """Whole tracks of similar length, few enough at a time that padding them to one length stays small."""
    if len(boxes.track) == 0:
        return
    starts = np.flatnonzero(np.diff(boxes.track, prepend=-1))
    stops = np.append(starts[1:], len(boxes.track))
    length = boxes.frame[stops - 1] - boxes.frame[starts] + 1
    order = np.argsort(length, kind="stable")
    first = 0
    while first < len(order):
        last = first + 1
        while last < len(order) and (last + 1 - first) * length[order[last]] <= _CELLS_AT_ONCE:
            last += 1
        rows = np.concatenate([np.arange(int(starts[one]), int(stops[one])) for one in order[first:last].tolist()])
        yield TrackBoxes(boxes.track[rows], boxes.frame[rows], boxes.xyxy_px[rows], boxes.noise[rows])
        first = last


def _smooth_block(boxes: TrackBoxes, time_s: _Array, config: TrackingConfig) -> Paths:
    """All tracks of a block in arrays (K steps, ..., N tracks), step 0 being each track's own first frame."""
    starts = np.flatnonzero(np.diff(boxes.track, prepend=-1))
    stops = np.append(starts[1:], len(boxes.track))
    track = np.repeat(np.arange(len(starts)), stops - starts)
    first = boxes.frame[starts]
    length = boxes.frame[stops - 1] - first + 1
    step = boxes.frame - first[track]
    steps, count = int(length.max()), len(starts)
    measured = np.zeros((steps, 2, 2, count))
    measured[step, 0, :, track] = (boxes.xyxy_px[:, :2] + boxes.xyxy_px[:, 2:]) / 2
    measured[step, 1, :, track] = boxes.xyxy_px[:, 2:] - boxes.xyxy_px[:, :2]
    noise = np.full((steps, count), np.inf)
    noise[step, track] = boxes.noise
    at_s = time_s[np.minimum(first + np.arange(steps)[:, None], len(time_s) - 1)]
    dt_s = np.diff(at_s, axis=0, prepend=at_s[:1])
    states = _filter(measured, noise, dt_s, config)
    _smooth_back(states, dt_s, length)
    k, n = (np.arange(steps)[:, None] < length).nonzero()
    return Paths(
        track=boxes.track[starts][n],
        frame=first[n] + k,
        position=states.position[k, :, :, n].reshape(-1, 4),
        speed=states.speed[k, :, :, n].reshape(-1, 4),
        variance=states.covariance[k, 0, :, n],
        speed_variance=states.covariance[k, 2, :, n],
    )


@dataclass(frozen=True, eq=False)
class _States:
    """``position``, ``speed`` (K, 2, 2, N) and ``covariance`` (K, 3, 2, N: of position, of both, of speed) after the
    detection of each step, and as predicted before it."""

    position: _Array
    speed: _Array
    covariance: _Array
    predicted_position: _Array
    predicted_speed: _Array
    predicted_covariance: _Array


def _filter(measured: _Array, noise: _Array, dt_s: _Array, config: TrackingConfig) -> _States:
    """Forward in time; where nothing was detected, ``noise`` is infinite and the gain 0."""
    steps, _, _, count = measured.shape
    boxes, covariances = (steps, 2, 2, count), (steps, 3, 2, count)
    states = _States(
        np.zeros(boxes),
        np.zeros(boxes),
        np.zeros(covariances),
        np.zeros(boxes),
        np.zeros(boxes),
        np.zeros(covariances),
    )
    ratio = np.array([[1.0], [config.smooth_growth_ratio]])
    density = np.square(config.smooth_speed_change_std_sizes * ratio)
    exactness = config.smooth_measurement_std_sizes**2
    position, speed = measured[0], np.zeros((2, 2, count))
    squared = _squared_size(position)
    variance = np.broadcast_to(exactness * squared * noise[0] ** 2, (2, count))
    covariance = np.zeros((2, count))
    speed_variance = np.square(config.initial_speed_std_sizes * ratio) * squared
    for k in range(steps):
        if k:
            dt = dt_s[k]
            grown = density * (_squared_size(position) * dt)
            position = position + dt * speed
            variance = variance + dt * (2 * covariance + dt * (speed_variance + grown / 3))
            covariance = covariance + dt * (speed_variance + grown / 2)
            speed_variance = speed_variance + grown
        states.predicted_position[k], states.predicted_speed[k] = position, speed
        states.predicted_covariance[k] = variance, covariance, speed_variance
        if k:
            total = variance + exactness * _squared_size(measured[k]) * noise[k] ** 2
            gain, speed_gain = variance / total, covariance / total
            surprise = measured[k] - position
            position = position + gain[:, None] * surprise
            speed = speed + speed_gain[:, None] * surprise
            speed_variance = speed_variance - speed_gain * covariance
            covariance = covariance - gain * covariance
            variance = variance - gain * variance
        states.position[k], states.speed[k] = position, speed
        states.covariance[k] = variance, covariance, speed_variance
    return states


def _smooth_back(states: _States, dt_s: _Array, length: NDArray[np.int64]) -> None:
    """Backward in time, in place: correct each step by what came after it, up to each track's own end."""
    for k in range(len(dt_s) - 2, -1, -1):
        a, b, c = states.covariance[k]
        p, q, r = states.predicted_covariance[k + 1]
        dt = dt_s[k + 1]
        u, v = a + dt * b, b + dt * c
        determinant = p * r - q * q
        scale = np.zeros_like(determinant)
        np.divide(1.0, determinant, out=scale, where=(determinant > 1e-12 * p * r) & (k + 1 < length))
        c00, c01 = (u * r - b * q) * scale, (b * p - u * q) * scale
        c10, c11 = (v * r - c * q) * scale, (c * p - v * q) * scale
        moved = states.position[k + 1] - states.predicted_position[k + 1]
        sped = states.speed[k + 1] - states.predicted_speed[k + 1]
        states.position[k] += c00[:, None] * moved + c01[:, None] * sped
        states.speed[k] += c10[:, None] * moved + c11[:, None] * sped
        x, y, z = states.covariance[k + 1] - states.predicted_covariance[k + 1]
        states.covariance[k, 0] += c00 * (c00 * x + c01 * y) + c01 * (c00 * y + c01 * z)
        states.covariance[k, 1] += c10 * (c00 * x + c01 * y) + c11 * (c00 * y + c01 * z)
        states.covariance[k, 2] += c10 * (c10 * x + c11 * y) + c11 * (c10 * y + c11 * z)


def _squared_size(position: _Array) -> _Array:
    """(N,) width times height, of sides of at least a pixel."""
    width, height = np.maximum(position[1], _MIN_SIDE_PX)
    return width * height
