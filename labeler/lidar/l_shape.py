"""The yaw of each cluster, from the L that two sides of a vehicle draw seen from above.

All yaws of a quarter turn are tried. For each, every point has a distance to the nearer of two opposite sides of the
tightest rectangle, along both axes; the yaw that brings most points close to a side wins (the closeness criterion).
With few points the criterion says little, so a weak preference for the ego's own direction decides, along which most
traffic runs.

Source: Zhang et al., Efficient L-Shape Fitting for Vehicle Detection Using Laser Scanners, IV 2017.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from labeler.lidar.config import LidarConfig

_QUARTER_TURN_DEG = 90.0
_PREFERENCE = 2.0


def fit_yaws(xy_m: NDArray[np.floating], start: NDArray[np.int64], config: LidarConfig) -> NDArray[np.float64]:
    """(C,) yaw in radians, 0 to a quarter turn, of C clusters: points ``start[i]:start[i + 1]`` of (P, 2) ``xy_m``."""
    clusters = len(start) - 1
    if clusters == 0:
        return np.zeros(0)
    rows, start = _thinned(start, config.max_fit_points)
    count = np.diff(start)
    first = start[:-1]
    middle = np.add.reduceat(xy_m[rows].astype(np.float64), first) / count[:, None]
    local = (xy_m[rows] - np.repeat(middle, count, axis=0)).astype(np.float32, copy=False)
    yaw_rad = np.radians(np.arange(0.0, _QUARTER_TURN_DEG, config.yaw_step_deg))
    cos, sin = np.cos(yaw_rad).astype(np.float32), np.sin(yaw_rad).astype(np.float32, copy=False)
    along = (local[:, :1] * cos + local[:, 1:] * sin).astype(np.float32, copy=False)
    across = (local[:, 1:] * cos - local[:, :1] * sin).astype(np.float32, copy=False)
    side_m = np.minimum(_to_nearer_side(along, first, count), _to_nearer_side(across, first, count))
    floor_m = np.float32(config.closeness_floor_m)
    closeness = np.add.reduceat(floor_m / np.maximum(side_m, floor_m), first)
    closeness += _PREFERENCE * np.square(np.cos(2 * yaw_rad)).astype(np.float32, copy=False)
    return yaw_rad[closeness.argmax(axis=1)]


def extents_along(
    xy_m: NDArray[np.floating], start: NDArray[np.int64], yaw_rad: NDArray[np.float64], *, outliers: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(C, 2) lowest and (C, 2) highest coordinate of each cluster along its yaw and across it, in metres.

    That share of the points, ``outliers``, is left out at each end."""
    count = np.diff(start)
    cluster = np.repeat(np.arange(len(count)), count)
    cos, sin = np.cos(yaw_rad)[cluster], np.sin(yaw_rad)[cluster]
    along = xy_m[:, 0] * cos + xy_m[:, 1] * sin
    across = xy_m[:, 1] * cos - xy_m[:, 0] * sin
    left_out = np.floor(outliers * count).astype(np.int64)
    ends = [_ordered(value, cluster) for value in (along, across)]
    low = np.stack([value[start[:-1] + left_out] for value in ends], axis=1)
    high = np.stack([value[start[1:] - 1 - left_out] for value in ends], axis=1)
    return low, high


def _ordered(value: NDArray[np.floating], cluster: NDArray[np.intp]) -> NDArray[np.float64]:
    return value[np.lexsort((value, cluster))].astype(np.float64)


def _to_nearer_side(
    value: NDArray[np.float32], first: NDArray[np.int64], count: NDArray[np.int64]
) -> NDArray[np.float32]:
    low = np.repeat(np.minimum.reduceat(value, first), count, axis=0)
    high = np.repeat(np.maximum.reduceat(value, first), count, axis=0)
    return np.minimum(value - low, high - value)


def _thinned(start: NDArray[np.int64], most: int) -> tuple[NDArray[np.intp], NDArray[np.int64]]:
    """Evenly spread rows, at most ``most`` of each cluster, and where each cluster begins among them."""
    count = np.diff(start)
    kept = np.minimum(count, most)
    begin = np.concatenate([[0], np.cumsum(kept)]).astype(np.int64)
    place = np.arange(int(begin[-1])) - np.repeat(begin[:-1], kept)
    rows = np.repeat(start[:-1], kept) + place * np.repeat(count, kept) // np.repeat(np.maximum(kept, 1), kept)
    return rows.astype(np.intp), begin
