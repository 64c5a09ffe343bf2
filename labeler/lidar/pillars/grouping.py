"""Points grouped into pillars: the columns of a square grid that hold any.

Every pillar holds the same number of points, evenly spread over its own from the lowest to the highest; where it has
fewer, they stand several times, which changes no maximum. So a network needs no mask.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

POINTS_PER_PILLAR = 8
OWN_FEATURES = 7
"""Features of a point beside its columns: place in the grid, and how far it is from its pillar's mean."""

_PLACE_UNIT_M = 50.0


@dataclass(frozen=True)
class Grid:
    """``rows`` cells along x from ``x_min_m``, ``columns`` along y from ``y_min_m``, of side ``cell_m``, in the frame
    of a camera's direction."""

    x_min_m: float
    y_min_m: float
    cell_m: float
    rows: int
    columns: int

    def __post_init__(self) -> None:
        if not (self.cell_m > 0 and self.rows > 0 and self.columns > 0):
            raise ValueError(f"Grid needs cells of some size, got {self}")

    @property
    def x_max_m(self) -> float:
        return self.x_min_m + self.rows * self.cell_m

    @property
    def y_max_m(self) -> float:
        return self.y_min_m + self.columns * self.cell_m


DIRECTION_GRID = Grid(x_min_m=-3.2, y_min_m=-41.6, cell_m=0.4, rows=136, columns=208)
"""What a camera of 100 degrees sees within 50 m, and what it cuts beside the car."""


@dataclass(frozen=True, eq=False)
class Pillars:
    """``points`` (P, POINTS_PER_PILLAR, columns + OWN_FEATURES - 2) float32 the points of each pillar as the network
    takes them, ``cell`` (P,) int64 the flat index of its cell, row times columns plus column."""

    points: NDArray[np.float32]
    cell: NDArray[np.int64]


def features_of(columns: int) -> int:
    """How many features a point of so many columns has in a pillar: x and y are told from the pillar's middle."""
    return columns - 2 + OWN_FEATURES


def pillars_of(cloud: NDArray[np.float32], grid: Grid) -> Pillars:
    """Group an (N, D) cloud of a direction (see :func:`labeler.lidar.pillars.direction.direction_cloud`). Points
    outside of the grid are left out.

    The features of a point are z, intensity and what else it carries, then x and y from the middle of its cell, x and y
    in the grid, and x, y and z from the mean of its pillar's points."""
    place = (cloud[:, :2] - np.array([grid.x_min_m, grid.y_min_m], np.float32)) / np.float32(grid.cell_m)
    with np.errstate(invalid="ignore"):
        inside = np.flatnonzero((place >= 0).all(axis=1) & (place < [grid.rows, grid.columns]).all(axis=1))
    corner = np.minimum(place[inside].astype(np.int64), [grid.rows - 1, grid.columns - 1])
    cell = corner[:, 0] * grid.columns + corner[:, 1]
    order = np.lexsort((cloud[inside, 2], cell))
    points, off = cloud[inside[order]], (place[inside] - corner - 0.5)[order]
    filled, start, count = np.unique(cell[order], return_index=True, return_counts=True)
    if not len(filled):
        return Pillars(np.zeros((0, POINTS_PER_PILLAR, features_of(cloud.shape[1])), np.float32), filled)
    mean_m = np.add.reduceat(points[:, :3], start, axis=0) / count[:, None]
    from_mean_m = points[:, :3] - np.repeat(mean_m, count, axis=0)
    features = np.concatenate([points[:, 2:], off, points[:, :2] / _PLACE_UNIT_M, from_mean_m], axis=1)
    share = np.linspace(0, 1, POINTS_PER_PILLAR)
    chosen = start[:, None] + np.rint((count[:, None] - 1) * share).astype(np.int64)
    return Pillars(features.astype(np.float32)[chosen], filled)
