"""How a box moves in the image: a Kalman filter with constant velocity.

The state is the box's centre, width and height in pixels, and the speed of each in pixels a second. Process noise is
white noise on the speed, so that it grows with the time between two images and any frame rate fits. All noise is
proportional to the size of the box, because a near object moves over more pixels than a far one. filterpy filters.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import cast

import numpy as np
from numpy.typing import NDArray

from labeler.tracking.config import TrackingConfig

_Array = NDArray[np.float64]
_MIN_SIDE_PX = 1.0

# filterpy has no types; reached by name, its functions get the ones that they fulfil.
_filterpy = import_module("filterpy.kalman")
_predict = cast(Callable[[_Array, _Array, _Array, _Array], tuple[_Array, _Array]], _filterpy.predict)
_update = cast(Callable[[_Array, _Array, _Array, _Array, _Array], tuple[_Array, _Array]], _filterpy.update)

_MEASURES_BOX = np.eye(4, 8)
_EYE_4 = np.eye(4)


@dataclass(frozen=True, eq=False)
class TimeStep:
    """What the time between two images does to every box: the (8, 8) transition, and the noise per unit of density."""

    transition: _Array
    unit_noise: _Array

    @staticmethod
    def of(dt_s: float) -> TimeStep:
        """The step of ``dt_s`` seconds; 0 leaves every box where it is."""
        transition = np.array([[1.0, dt_s], [0.0, 1.0]], np.float64)
        noise = np.array([[dt_s**3 / 3, dt_s**2 / 2], [dt_s**2 / 2, dt_s]], np.float64)
        return TimeStep(_for_each_coordinate(transition), _for_each_coordinate(noise))


class BoxMotion:
    """The filter of one box. Boxes are (4,) float64 ``x1, y1, x2, y2`` in pixels."""

    def __init__(self, xyxy_px: _Array, config: TrackingConfig) -> None:
        self._measurement_std_sizes = config.measurement_std_sizes
        ratio = np.array([1, 1, config.growth_ratio, config.growth_ratio], np.float64)
        self._speed_density_sizes = np.tile(np.square(config.speed_change_std_sizes * ratio), 2)
        self._mean = np.concatenate([_center_and_sides(xyxy_px), np.zeros(4)])
        position_std = np.full(4, config.measurement_std_sizes)
        stds = np.concatenate([position_std, config.initial_speed_std_sizes * ratio])
        self._covariance = np.diag(np.square(stds * _size_px(self._mean)))

    def predict(self, step: TimeStep) -> None:
        """Move the box on to the next image."""
        noise = step.unit_noise * (self._speed_density_sizes * _size_px(self._mean) ** 2)
        self._mean, self._covariance = _predict(self._mean, self._covariance, step.transition, noise)

    def update(self, xyxy_px: _Array) -> None:
        """Correct the box by a detected one of the same moment."""
        measured = _center_and_sides(xyxy_px)
        noise = _EYE_4 * (self._measurement_std_sizes * _size_px(measured)) ** 2
        self._mean, self._covariance = _update(self._mean, self._covariance, measured, noise, _MEASURES_BOX)

    @property
    def xyxy_px(self) -> _Array:
        """The box where the filter believes it to be; a side is never shorter than a pixel."""
        half = np.maximum(self._mean[2:4], _MIN_SIDE_PX) / 2
        return np.concatenate([self._mean[:2] - half, self._mean[:2] + half])

    @property
    def velocity_px_s(self) -> _Array:
        """(4,) speeds of centre x, centre y, width and height, in pixels a second."""
        return self._mean[4:].copy()


def _for_each_coordinate(position_and_speed: _Array) -> _Array:
    """(8, 8): the (2, 2) over position and speed for each of the four coordinates, which don't mix."""
    return np.kron(position_and_speed, _EYE_4).astype(np.float64, copy=False)


def _center_and_sides(xyxy_px: _Array) -> _Array:
    return np.concatenate([(xyxy_px[:2] + xyxy_px[2:]) / 2, xyxy_px[2:] - xyxy_px[:2]])


def _size_px(center_and_sides: _Array) -> float:
    width, height = center_and_sides[2:4].tolist()
    return math.sqrt(max(width, _MIN_SIDE_PX) * max(height, _MIN_SIDE_PX))
