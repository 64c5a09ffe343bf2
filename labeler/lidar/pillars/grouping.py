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

    def widened(self, cells: int) -> Grid:
        """The grid with so many more cells on all sides."""
        more_m = cells * self.cell_m
        rows, columns = self.rows + 2 * cells, self.columns + 2 * cells
        return Grid(self.x_min_m - more_m, self.y_min_m - more_m, self.cell_m, rows, columns)


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
    place_x = (cloud[:, 0] - np.float32(grid.x_min_m)) / np.float32(grid.cell_m)
    place_y = (cloud[:, 1] - np.float32(grid.y_min_m)) / np.float32(grid.cell_m)
    with np.errstate(invalid="ignore"):
        inside = np.flatnonzero((place_x >= 0) & (place_x < grid.rows) & (place_y >= 0) & (place_y < grid.columns))
    place_x, place_y = place_x[inside], place_y[inside]
    row, column = place_x.astype(np.int64), place_y.astype(np.int64)
    cell = row * grid.columns + column
    order = _by_cell_and_height(cell, cloud[inside, 2])
    cell, inside = cell[order], inside[order]
    start = np.flatnonzero(np.diff(cell, prepend=-1))
    filled, count = cell[start], np.diff(start, append=len(cell))
    if not len(filled):
        return Pillars(np.zeros((0, POINTS_PER_PILLAR, features_of(cloud.shape[1])), np.float32), filled)
    mean_m = np.add.reduceat(cloud[inside, :3], start, axis=0) / count[:, None].astype(np.float32)
    share = np.linspace(0, 1, POINTS_PER_PILLAR)
    chosen = start[:, None] + np.rint((count[:, None] - 1) * share).astype(np.int64)
    points = cloud[inside[chosen]]
    features = np.empty((len(filled), POINTS_PER_PILLAR, features_of(cloud.shape[1])), np.float32)
    columns = cloud.shape[1] - 2
    features[..., :columns] = points[..., 2:]
    features[..., columns] = (place_x - row - np.float32(0.5))[order][chosen]
    features[..., columns + 1] = (place_y - column - np.float32(0.5))[order][chosen]
    features[..., columns + 2 : columns + 4] = points[..., :2] / np.float32(_PLACE_UNIT_M)
    features[..., columns + 4 :] = points[..., :3] - mean_m[:, None]
    return Pillars(features, filled)


def _by_cell_and_height(cell: NDArray[np.int64], z_m: NDArray[np.float32]) -> NDArray[np.intp]:
    """The order of (N,) points by cell, then by height. Sorting one whole number a point is much faster than two keys:
    the bits of a float32 count like the float, once those of negative ones are turned round."""
    bits = z_m.view(np.int32)
    rising = np.where(bits < 0, bits ^ np.int32(0x7FFFFFFF), bits)
    return np.argsort((cell << 32) + rising, kind="stable")
