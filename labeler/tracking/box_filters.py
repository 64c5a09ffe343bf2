"""Constant-velocity Kalman filters of many boxes at once, in closed form.

Model and noise are those of :class:`labeler.tracking.motion.BoxMotion`: centre and sides move at a speed that wanders,
the box is measured, and all noise grows with the box's size. The four coordinates of a box don't mix, and x and y of
its centre share their variances, as do its width and height. So a box needs two 2x2 covariances instead of one 8x8,
their gains can be written out, and a step over any number of boxes is a fixed number of array operations.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from labeler.tracking.config import TrackingConfig

_Array = NDArray[np.float64]
_MIN_SIDE_PX = 1.0


class BoxFilters:
    """The filters of B boxes, by row in the order in which they were added.

    ``position`` and ``speed`` (2, 2, B) in pixels and pixels a second hold (centre, sides) by (x, y). ``variance``,
    ``covariance`` (of position and speed) and ``speed_variance`` (2, B) hold (centre, sides): x and y share them.
    """

    __slots__ = (
        "_density",
        "_initial_speed",
        "_measured",
        "covariance",
        "position",
        "speed",
        "speed_variance",
        "variance",
    )

    def __init__(self, config: TrackingConfig) -> None:
        ratio = np.array([[1.0], [config.growth_ratio]])
        self._measured = config.measurement_std_sizes**2
        self._density = np.square(config.speed_change_std_sizes * ratio)
        self._initial_speed = np.square(config.initial_speed_std_sizes * ratio)
        self.position: _Array = np.zeros((2, 2, 0))
        self.speed: _Array = np.zeros((2, 2, 0))
        self.variance: _Array = np.zeros((2, 0))
        self.covariance: _Array = np.zeros((2, 0))
        self.speed_variance: _Array = np.zeros((2, 0))

    def __len__(self) -> int:
        return self.variance.shape[1]

    def add(self, xyxy_px: _Array) -> None:
        """Begin filters at rest from (N, 4) boxes."""
        position = _center_and_sides(xyxy_px)
        squared = _squared_size(position)
        measured = np.broadcast_to(self._measured * squared, (2, len(squared)))
        self._append(position, np.zeros_like(position), measured, self._initial_speed * squared)

    def resume(self, position: _Array, speed: _Array, variance: _Array, speed_variance: _Array) -> None:
        """Begin filters from what is known: (N, 4) centre x, centre y, width and height and their speeds, and (N, 2)
        variances of centre and sides. Position and speed are taken as independent."""
        shape = (2, 2, len(position))
        self._append(position.T.reshape(shape), speed.T.reshape(shape), variance.T, speed_variance.T)

    def _append(self, position: _Array, speed: _Array, variance: _Array, speed_variance: _Array) -> None:
        self.position = np.concatenate([self.position, position], axis=2)
        self.speed = np.concatenate([self.speed, speed], axis=2)
        self.variance = np.concatenate([self.variance, variance], axis=1)
        self.covariance = np.concatenate([self.covariance, np.zeros_like(variance)], axis=1)
        self.speed_variance = np.concatenate([self.speed_variance, speed_variance], axis=1)

    def keep(self, rows: NDArray[np.intp] | NDArray[np.bool_]) -> None:
        """Drop all other filters."""
        self.position, self.speed = self.position[:, :, rows], self.speed[:, :, rows]
        self.variance, self.covariance = self.variance[:, rows], self.covariance[:, rows]
        self.speed_variance = self.speed_variance[:, rows]

    def predict(self, dt_s: float) -> None:
        """Move all boxes on by ``dt_s`` seconds; 0 leaves them where they are."""
        noise = self._density * (_squared_size(self.position) * dt_s)
        self.position = self.position + dt_s * self.speed
        self.variance = self.variance + dt_s * (2 * self.covariance + dt_s * (self.speed_variance + noise / 3))
        self.covariance = self.covariance + dt_s * (self.speed_variance + noise / 2)
        self.speed_variance = self.speed_variance + noise

    def update(self, rows: NDArray[np.intp], xyxy_px: _Array) -> None:
        """Correct the filters in ``rows`` (N,), none twice, by detected boxes (N, 4) of the same moment."""
        measured = _center_and_sides(xyxy_px)
        variance, covariance = self.variance[:, rows], self.covariance[:, rows]
        total = variance + self._measured * _squared_size(measured)
        gain, speed_gain = variance / total, covariance / total
        position = self.position[:, :, rows]
        surprise = measured - position
        self.position[:, :, rows] = position + gain[:, None] * surprise
        self.speed[:, :, rows] += speed_gain[:, None] * surprise
        self.variance[:, rows] = variance - gain * variance
        self.covariance[:, rows] = covariance - gain * covariance
        self.speed_variance[:, rows] -= speed_gain * covariance

    def corners_px(self) -> tuple[_Array, _Array]:
        """(2, B) upper left and (2, B) lower right corners where the filters believe the boxes to be; a side is never
        shorter than a pixel."""
        half = np.maximum(self.position[1], _MIN_SIDE_PX) / 2
        return self.position[0] - half, self.position[0] + half

    @property
    def xyxy_px(self) -> _Array:
        """(B, 4) boxes of :meth:`corners_px`."""
        return np.concatenate(self.corners_px()).T


def _center_and_sides(xyxy_px: _Array) -> _Array:
    """(2, 2, N) from (N, 4)."""
    upper_left, lower_right = xyxy_px[:, :2].T, xyxy_px[:, 2:].T
    return np.stack([(upper_left + lower_right) / 2, lower_right - upper_left])


def _squared_size(position: _Array) -> _Array:
    """(B,) width times height, of sides of at least a pixel."""
    width, height = np.maximum(position[1], _MIN_SIDE_PX)
    return width * height
