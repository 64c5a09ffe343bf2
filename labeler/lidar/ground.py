"""Where the ground is under each point of a sweep, for a rig of any height and on slopes.

Seen from above, the sweep is cut into cells. The lowest point of each cell bounds the ground from above; so does the
lowest point of a cell nearby, plus what a road can climb on the way. The lower envelope of all these bounds (a
morphological erosion by a cone, as in Vosselman's slope-based filter of 2000) goes through the ground and passes under
vehicles. Single points far below their surroundings (mirror images) are dropped first.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from labeler.lidar.config import LidarConfig

_STRAY_DEPTH_M = 1.0


@dataclass(frozen=True, eq=False)
class Ground:
    """The height of the ground on a square grid around the ego origin.

    ``height_m`` (cells, cells) float32, indexed by x then y, NaN where no point is in reach; ``cell_m`` the side of a
    cell; the grid's middle is the ego origin."""

    height_m: NDArray[np.float32]
    cell_m: float

    def at(self, xy_m: NDArray[np.floating]) -> NDArray[np.float32]:
        """(N,) float32 height in metres under (N, 2) places in the ego frame, bilinear; NaN where it is unknown."""
        cells = len(self.height_m)
        place = np.asarray(xy_m, np.float32) / np.float32(self.cell_m) + np.float32(cells / 2 - 0.5)
        place = np.clip(place, 0, cells - 1.001)
        low = place.astype(np.intp)
        share = place - low
        total = np.zeros(len(place), np.float32)
        weight_sum = np.zeros(len(place), np.float32)
        for dx, dy in ((0, 0), (0, 1), (1, 0), (1, 1)):
            value = self.height_m[low[:, 0] + dx, low[:, 1] + dy]
            weight = np.abs(1 - dx - share[:, 0]) * np.abs(1 - dy - share[:, 1]) + np.float32(1e-6)
            known = np.isfinite(value)
            total += np.where(known, value, 0) * weight
            weight_sum += np.where(known, weight, 0)
        return np.divide(total, weight_sum, out=np.full(len(place), np.nan, np.float32), where=weight_sum > 0)


def estimate_ground(xyz_m: NDArray[np.float32], config: LidarConfig) -> Ground:
    """The ground of a sweep of (N, 3) points in the ego frame; points that are not finite are ignored."""
    half = int(np.ceil(config.max_distance_m / config.ground_cell_m))
    lowest = _lowest_by_cell(xyz_m, half, config.ground_cell_m)
    lowest = _without_mirror_images(lowest, config)
    envelope = _eroded_by_cone(lowest, config)
    return Ground(np.where(np.isfinite(envelope), envelope, np.nan).astype(np.float32), config.ground_cell_m)


def above_ground(xyz_m: NDArray[np.floating], ground: Ground, config: LidarConfig) -> NDArray[np.bool_]:
    """(N,) bool: True for each of (N, 3) points that stands clear of the ground, or has no known ground under it."""
    clear_m = xyz_m[:, 2] - ground.at(xyz_m[:, :2])
    return ~(clear_m <= config.ground_clearance_m)


def _lowest_by_cell(xyz_m: NDArray[np.float32], half: int, cell_m: float) -> NDArray[np.float32]:
    """(2 half, 2 half) lowest z in each cell, inf in cells without points."""
    cell = np.floor(xyz_m[:, :2] / np.float32(cell_m)) + half
    inside = ((cell >= 0) & (cell < 2 * half)).all(axis=1) & np.isfinite(xyz_m[:, 2])
    index = cell[inside].astype(np.intp)
    lowest = np.full(4 * half * half, np.inf, np.float32)
    np.minimum.at(lowest, index[:, 0] * (2 * half) + index[:, 1], xyz_m[inside, 2])
    return lowest.reshape(2 * half, 2 * half)


def _without_mirror_images(lowest: NDArray[np.float32], config: LidarConfig) -> NDArray[np.float32]:
    """A cell far below everything around it holds a stray point: it takes the height of the next lowest cell."""
    second = ndimage.rank_filter(lowest, rank=1, size=5, mode="nearest")
    may_fall_m = _STRAY_DEPTH_M + config.ground_slope * 2 * config.ground_cell_m
    stray = np.isfinite(second) & (lowest < second - may_fall_m)
    return np.where(stray, second, lowest)


def _eroded_by_cone(lowest: NDArray[np.float32], config: LidarConfig) -> NDArray[np.float32]:
    """For each cell the lowest bound by the cells in reach: their height, plus what a road can climb from there."""
    radius = int(config.ground_reach_m / config.ground_cell_m)
    cells = len(lowest)
    padded = np.pad(lowest, radius, constant_values=np.inf)
    envelope = lowest.copy()
    for dx in range(-radius, radius + 1):
        for dy in range(-radius, radius + 1):
            distance_m = math.hypot(dx, dy) * config.ground_cell_m
            if 0 < distance_m <= config.ground_reach_m:
                nearby = padded[radius + dx : radius + dx + cells, radius + dy : radius + dy + cells]
                np.minimum(envelope, nearby + np.float32(distance_m * config.ground_slope), out=envelope)
    return envelope
