"""Where the ground is under each point of a sweep, for a rig of any height and on slopes.

Seen from above, the sweep is cut into cells, from coarse to fine. Low points of a coarse cell are nearly always ground,
even in traffic. Each finer level starts from the surface of the coarser one and takes over its own lowest points,
unless they stand higher above that surface than a road can rise within the cell (those are the undersides of things
that hide the ground), or far below it (those are mirror images). At the end the surface moves up from the lowest points
to the mean of the points close to it. So the ground under and behind a vehicle is carried on from where it is seen.

The idea of going from coarse to fine under a threshold is that of the progressive filters for airborne LiDAR (Zhang et
al., A progressive morphological filter for removing nonground measurements from airborne LiDAR data, TGRS 2003).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from labeler.lidar.config import LidarConfig

_LEVELS = 4
_EVERY = 3
_SLOPE_CELLS = 5
_STRAY_DEPTH_M = 0.5


@dataclass(frozen=True, eq=False)
class Ground:
    """The height of the ground on a square grid around the ego origin.

    ``height_m`` (cells, cells) float32 at the middle of each cell, indexed by x then y; NaN everywhere when the sweep
    has no points. ``cell_m`` is the side of a cell; the grid's middle is the ego origin."""

    height_m: NDArray[np.float32]
    cell_m: float

    def at(self, xy_m: NDArray[np.floating]) -> NDArray[np.float32]:
        """(N,) float32 height in metres under (N, 2) places in the ego frame: bilinear, beyond the grid that of its
        edge.
        """
        cells = len(self.height_m)
        low_x, share_x = self._place(xy_m[:, 0])
        low_y, share_y = self._place(xy_m[:, 1])
        flat = self.height_m.ravel()
        corner = low_x * cells + low_y
        near = flat[corner] + (flat[corner + 1] - flat[corner]) * share_y
        corner += cells
        far = flat[corner] + (flat[corner + 1] - flat[corner]) * share_y
        return (near + (far - near) * share_x).astype(np.float32, copy=False)

    def _place(self, value_m: NDArray[np.floating]) -> tuple[NDArray[np.intp], NDArray[np.float32]]:
        """Between which middles of cells a coordinate lies: the lower one, and the share of the way to the next."""
        cells = len(self.height_m)
        place = value_m.astype(np.float32, copy=False) / np.float32(self.cell_m) + np.float32(cells / 2 - 0.5)
        place = np.clip(np.nan_to_num(place), np.float32(0), np.float32(cells - 1.001))
        low = place.astype(np.intp)
        return low, (place - low).astype(np.float32, copy=False)


def estimate_ground(xyz_m: NDArray[np.float32], config: LidarConfig) -> Ground:
    """The ground of a sweep of (N, 3) points in the ego frame; points that are not finite are ignored."""
    coarsest = 2 ** (_LEVELS - 1)
    half = int(np.ceil(config.max_distance_m / config.ground_cell_m / coarsest)) * coarsest
    cell, inside = _cells_of(xyz_m, half, config.ground_cell_m)
    if not inside.any():
        return Ground(np.full((2 * half, 2 * half), np.nan, np.float32), config.ground_cell_m)
    z_m = xyz_m[inside, 2]
    levels = [_lowest_by_cell(cell, z_m, half)]
    for level in range(_LEVELS - 1):
        levels.append(_pooled(levels[-1], config.ground_cell_m * 2**level, config))
    surface = _coarsest_surface(levels[-1], config.ground_cell_m * coarsest, config)
    for level in range(_LEVELS - 2, -1, -1):
        surface = _refined(surface, levels[level], config.ground_cell_m * 2**level, config)
    ground = Ground(surface, config.ground_cell_m)
    some = np.flatnonzero(inside)[::_EVERY]
    residual_m = xyz_m[some, 2] - ground.at(xyz_m[some, :2])
    return Ground(surface + _mean_residual(cell[::_EVERY], residual_m, half, config), config.ground_cell_m)


def above_ground(xyz_m: NDArray[np.floating], ground: Ground, config: LidarConfig) -> NDArray[np.bool_]:
    """(N,) bool: True for each of (N, 3) points that stands clear of the ground, or has no known ground under it."""
    clear_m = xyz_m[:, 2] - ground.at(xyz_m[:, :2])
    return ~(clear_m <= config.ground_clearance_m)


def _cells_of(xyz_m: NDArray[np.float32], half: int, cell_m: float) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """The flat index of the cell of each point inside of the grid, and which points these are."""
    x = np.floor(xyz_m[:, 0] / np.float32(cell_m)) + half
    y = np.floor(xyz_m[:, 1] / np.float32(cell_m)) + half
    inside = (x >= 0) & (x < 2 * half) & (y >= 0) & (y < 2 * half) & np.isfinite(xyz_m[:, 2])
    return x[inside].astype(np.intp) * (2 * half) + y[inside].astype(np.intp), inside


def _lowest_by_cell(cell: NDArray[np.intp], z_m: NDArray[np.float32], half: int) -> NDArray[np.float32]:
    """(2 half, 2 half) lowest z in each cell, inf in cells without points."""
    lowest = np.full(4 * half * half, np.inf, np.float32)
    np.minimum.at(lowest, cell, z_m)
    return lowest.reshape(2 * half, 2 * half)


def _pooled(lowest: NDArray[np.float32], cell_m: float, config: LidarConfig) -> NDArray[np.float32]:
    """The lowest of each two by two cells, or the second lowest where that one lies much higher: then the lowest holds
    a mirror image of what stands above the ground.
    """
    cells = len(lowest) // 2
    blocks = lowest.reshape(cells, 2, cells, 2).swapaxes(1, 2).reshape(cells, cells, 4)
    ordered = np.sort(blocks, axis=2)
    first, second = ordered[..., 0], ordered[..., 1]
    may_fall_m = np.float32(_STRAY_DEPTH_M + config.ground_slope * cell_m)
    return np.where(np.isfinite(second) & (second > first + may_fall_m), second, first)


def _coarsest_surface(lowest: NDArray[np.float32], cell_m: float, config: LidarConfig) -> NDArray[np.float32]:
    """The coarsest cells without gaps, none farther from the median of its neighbours than a road can rise."""
    empty = ~np.isfinite(lowest)
    nearest = ndimage.distance_transform_edt(empty, return_distances=False, return_indices=True)
    filled = lowest[tuple(nearest)]
    usual = ndimage.median_filter(filled, size=3, mode="nearest")
    rise_m = np.float32(config.ground_slope * cell_m)
    return _raised_to_middle(np.clip(filled, usual - rise_m, usual + rise_m), usual, cell_m, config)


def _refined(
    coarse: NDArray[np.float32], lowest: NDArray[np.float32], cell_m: float, config: LidarConfig
) -> NDArray[np.float32]:
    """The surface with twice as many cells a side."""
    surface = _doubled(coarse)
    candidate = _raised_to_middle(lowest, surface, cell_m, config)
    usable = candidate <= surface + np.float32(config.ground_tolerance_m + config.ground_bend * cell_m)
    usable &= candidate >= surface - np.float32(config.ground_tolerance_m + config.ground_slope * cell_m)
    return np.where(usable, candidate, surface).astype(np.float32, copy=False)


def _raised_to_middle(
    lowest: NDArray[np.float32], surface: NDArray[np.float32], cell_m: float, config: LidarConfig
) -> NDArray[np.float32]:
    """On a slope the lowest point of a cell lies at its lower edge: raise it to the height of the middle, by the slope
    of ``surface`` over several cells.
    """
    rise_x, rise_y = (ndimage.uniform_filter(rise, _SLOPE_CELLS, mode="nearest") for rise in np.gradient(surface))
    to_middle = np.minimum((np.abs(rise_x) + np.abs(rise_y)) / 2, config.ground_slope * cell_m)
    return lowest + to_middle.astype(np.float32)


def _doubled(coarse: NDArray[np.float32]) -> NDArray[np.float32]:
    """Bilinear interpolation to twice as many cells a side."""
    for axis in (0, 1):
        before = np.take(coarse, np.maximum(np.arange(coarse.shape[axis]) - 1, 0), axis=axis)
        after = np.take(coarse, np.minimum(np.arange(coarse.shape[axis]) + 1, coarse.shape[axis] - 1), axis=axis)
        halves = np.stack([0.75 * coarse + 0.25 * before, 0.75 * coarse + 0.25 * after], axis=axis + 1)
        shape = list(coarse.shape)
        shape[axis] *= 2
        coarse = halves.reshape(shape)
    return coarse


def _mean_residual(
    cell: NDArray[np.intp], residual_m: NDArray[np.float32], half: int, config: LidarConfig
) -> NDArray[np.float32]:
    """(2 half, 2 half) mean height over the surface of the points close to it, in each cell's neighbourhood."""
    close = np.abs(residual_m) <= config.ground_clearance_m
    size = 4 * half * half
    count = np.bincount(cell[close], minlength=size).astype(np.float32).reshape(2 * half, 2 * half)
    total = np.bincount(cell[close], residual_m[close], size).astype(np.float32).reshape(2 * half, 2 * half)
    count, total = ndimage.uniform_filter(count, 3), ndimage.uniform_filter(total, 3)
    return np.divide(total, count, out=np.zeros_like(total), where=count > 1e-3)
