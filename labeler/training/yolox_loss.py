"""What the detector learns from: overlap of boxes, objectness, class (arXiv:2107.08430).

Two things are added. Cells inside an *ignored* box (an object of which too little shows to be asked for) say nothing
about objectness, neither yes nor no. And the class's target is the overlap, as in the paper, so that the score that
comes out at the end (objectness times class) says how well the box fits."""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn.functional import binary_cross_entropy_with_logits

from labeler.detection.decode import anchor_grid
from labeler.training.assignment import assign, iou, one_of
from labeler.training.devices import on_device
from labeler.training.pictures import Picture

_OVERLAP_WEIGHT = 5.0
_LARGEST_LOG_SIZE = 8.0
_HOLDS_NOTHING_PX = np.array([1, 1, 0, 0], np.float32)


@dataclass(frozen=True, eq=False)
class TrueObjects:
    """What N inputs show, each filled up to as many objects as the fullest has: ``boxes_px`` (N, G, 4) float32 as
    corners, ``classes`` (N, G) int64, ``is_there`` (N, G) bool, False where it is filled up; and ``ignored_px``
    (N, I, 4) float32, boxes where nothing is asked, filled up with such as hold no point."""

    boxes_px: Tensor
    classes: Tensor
    is_there: Tensor
    ignored_px: Tensor

    @staticmethod
    def of(pictures: Sequence[Picture], device: torch.device) -> TrueObjects:
        """What the pictures show, on a device."""
        boxes_px = _filled_up([picture.boxes_px for picture in pictures], np.zeros(4, np.float32))
        classes = _filled_up([picture.classes for picture in pictures], np.zeros((), np.int64))
        is_there = _filled_up(
            [np.ones(len(picture.boxes_px), np.bool_) for picture in pictures], np.zeros((), np.bool_)
        )
        ignored_px = _filled_up([picture.ignored_px for picture in pictures], _HOLDS_NOTHING_PX)
        return TrueObjects(*(on_device(array, device) for array in (boxes_px, classes, is_there, ignored_px)))


def _filled_up(rows: Sequence[NDArray[np.generic]], filler: NDArray[np.generic]) -> NDArray[np.generic]:
    """(N, M, ...) the N arrays, each filled up to the length of the longest, at least one."""
    longest = max(1, *(len(row) for row in rows))
    filled = np.broadcast_to(filler, (len(rows), longest, *filler.shape)).copy()
    for number, row in enumerate(rows):
        filled[number, : len(row)] = row
    return filled


def yolox_loss(cells: Tensor, truth: TrueObjects, input_hw: tuple[int, int]) -> Tensor:
    """A scalar, from the network's output (N, A, 5 + C) for an input of this height and width, and the truth of N."""
    corner, stride = _grid_on(input_hw, cells.device)
    centers_px = (corner + 0.5) * stride
    middle = (cells[..., :2] + corner) * stride
    half = cells[..., 2:4].clamp(max=_LARGEST_LOG_SIZE).exp() * stride / 2
    boxes_px = torch.cat([middle - half, middle + half], dim=2)
    objectness, classes = cells[..., 4], cells[..., 5:]

    chosen = assign(
        boxes_px, objectness, classes, centers_px, stride.squeeze(1), truth.boxes_px, truth.classes, truth.is_there
    )  # fmt: skip
    takes = chosen.takes.to(cells.dtype)
    overlaps = iou(chosen.of_cells(boxes_px), truth.boxes_px[:, :, None])
    wanted = one_of(truth.classes, classes.shape[2])[:, :, None] * chosen.overlaps[..., None]
    said = binary_cross_entropy_with_logits(chosen.of_cells(classes), wanted, reduction="none").sum(dim=3)
    of_objects = (takes * (_OVERLAP_WEIGHT * (1 - overlaps.square()) + said)).sum()

    is_object = torch.zeros_like(objectness).scatter_add(1, chosen.cells.flatten(1), takes.flatten(1))
    is_asked = (is_object > 0) | ~_inside_any(centers_px, truth.ignored_px)
    each = binary_cross_entropy_with_logits(objectness, is_object, reduction="none")
    return (of_objects + (each * is_asked).sum()) / takes.sum().clamp(min=1)


@lru_cache(maxsize=32)
def _grid_on(input_hw: tuple[int, int], device: torch.device) -> tuple[Tensor, Tensor]:
    """(A, 2) column and row, and (A, 1) stride of each cell, in the memory of a device: sent there once. Read only."""
    grid = anchor_grid(input_hw)
    return on_device(grid.cell.copy(), device), on_device(grid.stride_px.copy(), device)


def _inside_any(points_px: Tensor, boxes_px: Tensor) -> Tensor:
    """(N, P) whether a point (P, 2) lies in one of the boxes (N, B, 4)."""
    x, y = points_px[:, 0], points_px[:, 1]
    left, top, right, bottom = boxes_px[..., None].unbind(dim=2)
    return ((x >= left) & (y >= top) & (x <= right) & (y <= bottom)).any(dim=1)
