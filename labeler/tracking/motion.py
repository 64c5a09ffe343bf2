"""How a box moves in the image: a Kalman filter with constant velocity.

The state is the box's centre, width and height in pixels, and the speed of each in pixels a second. Process noise is
white noise on the speed, so that it grows with the time between two images and any frame rate fits. All noise is
proportional to the size of the box, because a near object moves over more pixels than a far one. filterpy filters.
"""

from __future__ import annotations

from collections.abc import Callable
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


class BoxMotion:
    """The filter of one box. Boxes are (4,) float64 ``x1, y1, x2, y2`` in pixels."""

    def __init__(self, xyxy_px: _Array, config: TrackingConfig) -> None:
        self._config = config
        self._mean = np.concatenate([_center_and_sides(xyxy_px), np.zeros(4)])
        self._speed_ratio = np.array([1, 1, config.growth_ratio, config.growth_ratio], np.float64)
        position_std = np.full(4, config.measurement_std_sizes)
        speed_std = config.initial_speed_std_sizes * self._speed_ratio
        self._covariance = np.diag(np.square(np.concatenate([position_std, speed_std]) * self._size_px))

    def predict(self, dt_s: float) -> None:
        """Move the box on by ``dt_s`` seconds (0 leaves it where it is)."""
        change = np.square(self._config.speed_change_std_sizes * self._size_px * self._speed_ratio)
        self._mean, self._covariance = _predict(
            self._mean,
            self._covariance,
            _blocks([[1.0, dt_s], [0.0, 1.0]], np.ones(4)),
            _blocks([[dt_s**3 / 3, dt_s**2 / 2], [dt_s**2 / 2, dt_s]], change),
        )

    def update(self, xyxy_px: _Array) -> None:
        """Correct the box by a detected one of the same moment."""
        measured = _center_and_sides(xyxy_px)
        noise = _EYE_4 * np.square(self._config.measurement_std_sizes * _size_px(measured))
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

    @property
    def _size_px(self) -> float:
        return _size_px(self._mean)


def _blocks(position_and_speed: list[list[float]], scale: _Array) -> _Array:
    """(8, 8): the (2, 2) over position and speed for each coordinate, times its scale (4,); coordinates don't mix."""
    return np.kron(np.array(position_and_speed, np.float64), np.diag(scale)).astype(np.float64, copy=False)


def _center_and_sides(xyxy_px: _Array) -> _Array:
    return np.concatenate([(xyxy_px[:2] + xyxy_px[2:]) / 2, xyxy_px[2:] - xyxy_px[:2]])


def _size_px(center_and_sides: _Array) -> float:
    width, height = np.maximum(center_and_sides[2:4], _MIN_SIDE_PX)
    return float(np.sqrt(width * height))
