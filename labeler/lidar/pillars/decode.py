"""What the pillar network puts out, and how boxes are made of it.

A cell of the output says how likely the middle of a vehicle lies in it (``HEAT``), how well its box would overlap the
vehicle (``QUALITY``), and the box: where its middle is from the middle of the cell, its height above the ground, the
logarithms of its sides, its axis as sine and cosine of twice the yaw (a box and the same box turned by half are alike),
its heading as sine and cosine of the yaw, of which only the end that is the front is taken, and the logarithms of
standard deviations.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from labeler.geometry.boxes_3d import bev_intersection, bev_iou_limit
from labeler.lidar.pillars.grouping import Grid

STRIDE = 2
"""Cells of the grid that a cell of the output covers, along each side."""

_MOST_BOXES = 100
_SAME_PLACE_IOU = 0.2
_LOG_SIDE_LIMITS = (-1.0, 3.5)


class Outputs:
    """The channels of the output, by number or slice."""

    HEAT = 0
    QUALITY = 1
    OFFSET = slice(2, 4)
    HEIGHT = 4
    LOG_SIZE = slice(5, 8)
    AXIS = slice(8, 10)
    HEADING = slice(10, 12)
    LOG_STD = slice(12, 15)
    CLASSES = 15

    @staticmethod
    def channels(class_count: int) -> int:
        return Outputs.CLASSES + class_count


@dataclass(frozen=True, eq=False)
class PillarBoxes:
    """Boxes in the frame of a direction, the surest first: ``center_m`` (N, 3) with z above the ground, ``size_m``
    (N, 3), ``yaw_rad`` (N,), ``score`` (N,) in 0..1, ``class_index`` (N,) in the network's classes and ``class_score``
    (N,), ``std`` (N, 3): along the length and across it in metres, of the yaw in radians."""

    center_m: NDArray[np.float64]
    size_m: NDArray[np.float64]
    yaw_rad: NDArray[np.float64]
    score: NDArray[np.float64]
    class_index: NDArray[np.intp]
    class_score: NDArray[np.float64]
    std: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.score)

    def __getitem__(self, rows: NDArray[np.bool_] | NDArray[np.intp]) -> PillarBoxes:
        return PillarBoxes(
            self.center_m[rows], self.size_m[rows], self.yaw_rad[rows], self.score[rows], self.class_index[rows],
            self.class_score[rows], self.std[rows],
        )  # fmt: skip


def cell_middles(grid: Grid) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """x of each row and y of each column of the output, in the middle of its cells."""
    side_m = grid.cell_m * STRIDE
    row, column = np.arange(grid.rows // STRIDE, dtype=np.float64), np.arange(grid.columns // STRIDE, dtype=np.float64)
    return grid.x_min_m + (row + 0.5) * side_m, grid.y_min_m + (column + 0.5) * side_m


def decode(output: NDArray[np.float32], grid: Grid, *, min_score: float) -> PillarBoxes:
    """The boxes in (C, rows, columns) of output: the cells that are likelier than their neighbours, without those
    whose box overlaps a surer one."""
    heat = _sigmoid(output[Outputs.HEAT])
    score = np.sqrt(heat * _sigmoid(output[Outputs.QUALITY]))
    highest = (heat == ndimage.maximum_filter(heat, size=3, mode="constant")) & (score >= min_score)
    row, column = np.nonzero(highest)
    order = np.argsort(-score[row, column], kind="stable")[:_MOST_BOXES]
    row, column = row[order], column[order]
    said = output[:, row, column].astype(np.float64)
    x_m, y_m = cell_middles(grid)
    center_m = np.stack([x_m[row] + said[2], y_m[column] + said[3], said[Outputs.HEIGHT]], axis=1)
    (sin, cos), (ahead_sin, ahead_cos) = said[Outputs.AXIS], said[Outputs.HEADING]
    axis_rad: NDArray[np.float64] = np.arctan2(sin, cos) / 2
    backwards = np.cos(axis_rad) * ahead_cos + np.sin(axis_rad) * ahead_sin < 0
    yaw_rad = axis_rad + np.where(backwards, np.pi, 0.0)
    chance = np.exp(said[Outputs.CLASSES :] - said[Outputs.CLASSES :].max(axis=0, keepdims=True, initial=-np.inf))
    chance /= chance.sum(axis=0, keepdims=True)
    found = PillarBoxes(
        center_m=center_m,
        size_m=np.exp(np.clip(said[Outputs.LOG_SIZE], *_LOG_SIDE_LIMITS)).T,
        yaw_rad=(yaw_rad + np.pi) % (2 * np.pi) - np.pi,
        score=score[row, column].astype(np.float64),
        class_index=chance.argmax(axis=0) if len(row) else np.zeros(0, np.intp),
        class_score=chance.max(axis=0, initial=0),
        std=np.exp(np.clip(said[Outputs.LOG_STD], -5, 3)).T,
    )
    return found[without_overlaps(found)]


def without_overlaps(boxes: PillarBoxes) -> NDArray[np.intp]:
    """The rows of boxes that overlap no surer one that stays; two objects can't be in one place."""
    kept: list[int] = []
    may_overlap = bev_iou_limit(boxes.center_m, boxes.size_m, boxes.yaw_rad) > _SAME_PLACE_IOU
    for row in range(len(boxes)):
        near = [other for other in kept if may_overlap[row, other]]
        if all(_bev_iou(boxes, row, other) <= _SAME_PLACE_IOU for other in near):
            kept.append(row)
    return np.array(kept, np.intp)


def _bev_iou(boxes: PillarBoxes, a: int, b: int) -> float:
    shared_m2 = bev_intersection(
        boxes.center_m[a], boxes.size_m[a], float(boxes.yaw_rad[a]),
        boxes.center_m[b], boxes.size_m[b], float(boxes.yaw_rad[b]),
    )  # fmt: skip
    areas_m2 = float(boxes.size_m[a, :2].prod() + boxes.size_m[b, :2].prod())
    return shared_m2 / max(areas_m2 - shared_m2, 1e-9)


def _sigmoid(logits: NDArray[np.float32]) -> NDArray[np.float64]:
    return 1 / (1 + np.exp(-np.clip(logits.astype(np.float64), -30, 30)))
