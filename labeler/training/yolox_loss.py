"""What the detector learns from: overlap of boxes, objectness, class (arXiv:2107.08430).

Two things are added. Cells inside an *ignored* box (an object of which too little shows to be asked for) say nothing
about objectness, neither yes nor no. And the class's target is the overlap, as in the paper, so that the score that
comes out at the end (objectness times class) says how well the box fits."""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor
from torch.nn.functional import binary_cross_entropy_with_logits, one_hot

from labeler.detection.decode import anchor_grid
from labeler.training.assignment import assign, iou

_OVERLAP_WEIGHT = 5.0
_LARGEST_LOG_SIZE = 8.0


@dataclass(frozen=True, eq=False)
class TrueObjects:
    """What one input shows: ``boxes_px`` (G, 4) float32 as corners, ``classes`` (G,) int64, and ``ignored_px`` (I, 4)
    float32, boxes where nothing is asked."""

    boxes_px: Tensor
    classes: Tensor
    ignored_px: Tensor


def yolox_loss(cells: Tensor, truths: Sequence[TrueObjects], input_hw: tuple[int, int]) -> Tensor:
    """A scalar, from the network's output (N, A, 5 + C) for an input of this height and width, and the N truths."""
    grid = anchor_grid(input_hw)
    corner, stride = torch.from_numpy(grid.cell.copy()), torch.from_numpy(grid.stride_px.copy())
    centers_px = (corner + 0.5) * stride
    middle = (cells[..., :2] + corner) * stride
    half = cells[..., 2:4].clamp(max=_LARGEST_LOG_SIZE).exp() * stride / 2
    boxes_px = torch.cat([middle - half, middle + half], dim=2)
    objectness, classes = cells[..., 4], cells[..., 5:]

    loss, asked_cells = cells.new_zeros(()), 0
    for row, truth in enumerate(truths):
        is_object = torch.zeros_like(objectness[row])
        if len(truth.boxes_px):
            chosen = assign(
                boxes_px[row],
                objectness[row],
                classes[row],
                centers_px,
                stride.squeeze(1),
                truth.boxes_px,
                truth.classes,
            )
            is_object[chosen.cells] = 1
            asked_cells += len(chosen.cells)
            overlaps = iou(boxes_px[row, chosen.cells], truth.boxes_px[chosen.objects])
            wanted = one_hot(truth.classes[chosen.objects], classes.shape[2]) * chosen.overlaps[:, None]
            loss = loss + _OVERLAP_WEIGHT * (1 - overlaps.square()).sum()
            loss = loss + binary_cross_entropy_with_logits(classes[row, chosen.cells], wanted, reduction="sum")
        is_asked = (is_object > 0) | ~_inside_any(centers_px, truth.ignored_px)
        each = binary_cross_entropy_with_logits(objectness[row], is_object, reduction="none")
        loss = loss + each[is_asked].sum()
    return loss / max(asked_cells, 1)


def _inside_any(points_px: Tensor, boxes_px: Tensor) -> Tensor:
    """(P,) whether a point (P, 2) lies in one of the boxes (B, 4)."""
    after = points_px[:, None] >= boxes_px[None, :, :2]
    before = points_px[:, None] <= boxes_px[None, :, 2:]
    return (after & before).all(dim=2).any(dim=1)
