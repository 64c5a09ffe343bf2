"""Constant-velocity Kalman filters of many boxes at once, in closed form.

Model and noise are those of :class:`labeler.tracking.motion.BoxMotion`: centre and sides move at a speed that wanders,
the box is measured, and all noise grows with the box's size. The four coordinates of a box don't mix, and x and y of
its centre share their variances, as do its width and height. So a box needs two 2x2 covariances instead of one 8x8,
fourteen numbers in all. Time moves them by one matrix that is the same for every box, the gains can be written out, and
a step over any number of boxes is a few array operations.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.tracking.config import TrackingConfig

_Array = NDArray[np.float64]
_MIN_SIDE_PX = 1.0

POSITION, SPEED = slice(0, 4), slice(4, 8)
VARIANCE, COVARIANCE, SPEED_VARIANCE = slice(8, 10), slice(10, 12), slice(12, 14)
_NUMBERS = 14

_CENTER_AND_SIDES = np.array([[0.5, 0, 0.5, 0], [0, 0.5, 0, 0.5], [-1, 0, 1, 0], [0, -1, 0, 1]])


@dataclass(frozen=True, eq=False, slots=True)
class Measured:
    """Detected boxes: ``position`` (4, N), centre x, centre y, width and height in pixels, and ``error`` (N,), the
    variance of each of these."""

    position: _Array
    error: _Array

    def __getitem__(self, boxes: slice) -> Measured:
        return Measured(self.position[:, boxes], self.error[boxes])


class BoxFilters:
    """The filters of B boxes, by column in the order in which they were added.

    The rows of ``state`` (14, B) are centre x, centre y, width and height in pixels (POSITION), their speeds in pixels
    a second (SPEED), and the VARIANCE of position, its COVARIANCE with speed and the SPEED_VARIANCE, each of centre and
    sides.
    """

    __slots__ = ("_density", "_initial_speed", "_measured", "_step_of", "_steps", "state")

    def __init__(self, config: TrackingConfig) -> None:
        ratio = np.array([[1.0], [config.growth_ratio]])
        self._measured = config.measurement_std_sizes**2
        self._density = np.square(config.speed_change_std_sizes * ratio)
        self._initial_speed = np.square(config.initial_speed_std_sizes * ratio)
        self._step_of: float | None = None
        self._steps: tuple[_Array, _Array] | None = None
        self.state: _Array = np.zeros((_NUMBERS, 0))

    def __len__(self) -> int:
        return self.state.shape[1]

    def add(self, measured: Measured) -> None:
        """Begin filters at rest."""
        new = np.zeros((_NUMBERS, len(measured.error)))
        new[POSITION] = measured.position
        new[VARIANCE] = measured.error
        new[SPEED_VARIANCE] = self._initial_speed * squared_size(measured.position)
        self.state = np.concatenate([self.state, new], axis=1)

    def resume(self, position: _Array, speed: _Array, variance: _Array, speed_variance: _Array) -> None:
        """Begin filters from what is known: (N, 4) centre x, centre y, width and height and their speeds, and (N, 2)
        variances of centre and sides. Position and speed are taken as independent."""
        parts = [position.T, speed.T, variance.T, np.zeros_like(variance.T), speed_variance.T]
        self.state = np.concatenate([self.state, np.concatenate(parts)], axis=1)

    def keep(self, columns: NDArray[np.bool_]) -> None:
        """Drop all other filters."""
        self.state = self.state.compress(columns, axis=1)

    def keep_first(self, count: int) -> None:
        """Drop all filters but the first."""
        self.state = self.state[:, :count]

    def predict(self, dt_s: float) -> None:
        """Move all boxes on by ``dt_s`` seconds; 0 leaves them where they are."""
        transition, noise = self._step(dt_s)
        grown = noise * squared_size(self.state)
        self.state = transition @ self.state
        self.state[8:] += grown

    def move(self, moved_px: _Array) -> None:
        """Move all boxes by what is known (4, B), in centre x, centre y, width and height."""
        self.state[POSITION] += moved_px

    def predict_each(self, dt_s: _Array) -> None:
        """Move each box on by seconds of its own (B,)."""
        state = self.state.copy()
        grown = squared_size(state) * self._density
        state[POSITION] += dt_s * state[SPEED]
        state[VARIANCE] += dt_s * (2 * state[COVARIANCE] + dt_s * state[SPEED_VARIANCE]) + dt_s**3 / 3 * grown
        state[COVARIANCE] += dt_s * state[SPEED_VARIANCE] + dt_s**2 / 2 * grown
        state[SPEED_VARIANCE] += dt_s * grown
        self.state = state

    def measure(self, xyxy_px: _Array, noise: _Array | None = None) -> Measured:
        """What detected boxes (N, 4) say. ``noise`` (N,) is how much farther off a box is than usual (a factor on the
        standard deviation)."""
        position = _CENTER_AND_SIDES @ xyxy_px.T
        error = self._measured * squared_size(position)
        return Measured(position, error if noise is None else error * np.square(noise))

    def update(self, columns: NDArray[np.intp] | slice, measured: Measured) -> None:
        """Correct the filters in ``columns``, none twice, by what was measured of each at the same moment."""
        state = self.state[:, columns] if isinstance(columns, slice) else self.state.take(columns, axis=1)
        count = state.shape[1]
        parts = state.reshape(7, 2, count)  # centre and sides of each of: position (2), speed (2), variances (3)
        gain = parts[4:6] / (parts[4] + measured.error)
        surprise = (measured.position - state[POSITION]).reshape(2, 2, count)
        moving = state[:8].reshape(2, 2, 2, count)
        moving += gain[:, :, None] * surprise
        parts[6] -= gain[1] * parts[5]
        parts[4:6] -= gain[0] * parts[4:6]
        if not isinstance(columns, slice):
            self.state[:, columns] = state

    def _step(self, dt_s: float) -> tuple[_Array, _Array]:
        """What ``dt_s`` seconds do to every box: the (14, 14) transition, and (6, 1) what they add to the variances of
        a box of one square pixel. Recordings have an even rate, so the last one is mostly the right one."""
        if self._steps is None or self._step_of != dt_s:
            transition = np.eye(_NUMBERS)
            transition[POSITION, SPEED] = dt_s * np.eye(4)
            transition[VARIANCE, COVARIANCE] = 2 * dt_s * np.eye(2)
            transition[VARIANCE, SPEED_VARIANCE] = dt_s**2 * np.eye(2)
            transition[COVARIANCE, SPEED_VARIANCE] = dt_s * np.eye(2)
            noise = np.concatenate([dt_s**3 / 3 * self._density, dt_s**2 / 2 * self._density, dt_s * self._density])
            self._step_of, self._steps = dt_s, (transition, noise)
        return self._steps

    def corners_px(self) -> tuple[_Array, _Array]:
        """(2, B) upper left and (2, B) lower right corners where the filters believe the boxes to be; a side is never
        shorter than a pixel."""
        half = np.maximum(self.state[2:4], _MIN_SIDE_PX)
        half *= 0.5
        return self.state[:2] - half, self.state[:2] + half

    @property
    def xyxy_px(self) -> _Array:
        """(B, 4) boxes of :meth:`corners_px`."""
        return np.concatenate(self.corners_px()).T


def squared_size(state: _Array) -> _Array:
    """(B,) width times height, of sides of at least a pixel; ``state`` (4 or more, B) begins with the position."""
    width, height = np.maximum(state[2:4], _MIN_SIDE_PX)
    return width * height
