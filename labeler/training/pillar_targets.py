"""What the pillar network shall answer for an example, cell by cell."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.lidar.pillars.decode import cell_middles
from labeler.training.cloud_examples import CloudExample, near_window

_SPREAD, _LEAST_SPREAD_M = 0.25, 0.5
_LEARNS_BOX = 0.4
_AROUND_IGNORED_M = 0.5
_EDGE_RAD = np.radians(2.0)


@dataclass(frozen=True, eq=False)
class PillarTargets:
    """``heat`` (R, C) float32: 1 where the middle of a vehicle lies, falling off around it; ``counts`` (R, C) bool:
    where an answer is asked for. ``cell`` (K,) the flat cells that learn a box, with ``weight`` (K,), ``box`` (K, 7)
    of which x and y are from the middle of the cell, and ``classes`` (K,). ``objects`` is how many vehicles there are.
    """

    heat: NDArray[np.float32]
    counts: NDArray[np.bool_]
    cell: NDArray[np.int64]
    weight: NDArray[np.float32]
    box: NDArray[np.float32]
    classes: NDArray[np.int64]
    objects: int


def targets_of(example: CloudExample) -> PillarTargets:
    """Vehicles that are asked for, in cells that the image reaches or that lie close to one of them."""
    x_m, y_m = cell_middles(example.grid)
    reaching = near_window(example)
    heat, owner = np.zeros((len(x_m), len(y_m)), np.float32), np.zeros((len(x_m), len(y_m)), np.int64)
    azimuth = np.arctan2(y_m[None, :], x_m[:, None])
    counts = (azimuth >= example.reach_rad[0] - _EDGE_RAD) & (azimuth <= example.reach_rad[1] + _EDGE_RAD)
    for row in np.flatnonzero(reaching & ~example.asked).tolist():
        off_x, off_y = x_m[:, None] - example.truth[row, 0], y_m[None, :] - example.truth[row, 1]
        cos, sin = np.cos(example.truth[row, 6]), np.sin(example.truth[row, 6])
        near = np.abs(cos * off_x + sin * off_y) < example.truth[row, 3] / 2 + _AROUND_IGNORED_M
        counts &= ~(near & (np.abs(cos * off_y - sin * off_x) < example.truth[row, 4] / 2 + _AROUND_IGNORED_M))
    objects = 0
    for row in np.flatnonzero(reaching & example.asked).tolist():
        off_x, off_y = x_m - example.truth[row, 0], y_m - example.truth[row, 1]
        nearest = int(np.abs(off_x).argmin()), int(np.abs(off_y).argmin())
        if max(abs(float(off_x[nearest[0]])), abs(float(off_y[nearest[1]]))) > example.grid.cell_m:
            continue
        spread_m = max(_SPREAD * np.sqrt(float(example.truth[row, 3] * example.truth[row, 4])), _LEAST_SPREAD_M)
        peak = np.exp(-(np.square(off_x)[:, None] + np.square(off_y)[None, :]) / (2 * spread_m**2)).astype(np.float32)
        counts |= peak > 0.1
        peak[nearest] = 1.0
        owner[peak > heat] = row
        heat = np.maximum(heat, peak)
        objects += 1
    cell = np.flatnonzero(heat.ravel() > _LEARNS_BOX)
    row = owner.ravel()[cell]
    box = example.truth[row]
    box[:, 0] -= x_m[cell // len(y_m)]
    box[:, 1] -= y_m[cell % len(y_m)]
    return PillarTargets(
        heat, counts, cell, heat.ravel()[cell], box.astype(np.float32), example.classes[row].astype(np.int64), objects
    )
