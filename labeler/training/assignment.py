"""Which cells of the YOLOX output learn which object: SimOTA (arXiv:2107.08430, section 2.1).

Cells near an object's middle are candidates. An object takes as many of them as its best overlaps add up to, the
cheapest first, where the cost is that of the class and of the overlap; a cell wanted by two goes to the cheaper one.
"""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

_CENTER_RADIUS_CELLS = 1.5
_OVERLAP_WEIGHT = 3.0
_OVERLAPS_COUNTED = 10
_FAR = 1e6


@dataclass(frozen=True, eq=False)
class Assignment:
    """For the cells that learn an object: ``cells`` (K,) int64 rows of the output, ``objects`` (K,) int64 the object of
    each, ``overlaps`` (K,) float32 the IoU of what the cell predicts now with that object."""

    cells: Tensor
    objects: Tensor
    overlaps: Tensor


@torch.no_grad()
def assign(
    boxes_px: Tensor, objectness: Tensor, classes: Tensor, centers_px: Tensor, strides_px: Tensor,
    true_boxes_px: Tensor, true_classes: Tensor,
) -> Assignment:  # fmt: skip
    """Of one image: predicted ``boxes_px`` (A, 4) as corners, logits of ``objectness`` (A,) and ``classes`` (A, C), the
    cells' ``centers_px`` (A, 2) and ``strides_px`` (A,), and its G objects, ``true_boxes_px`` (G, 4) and
    ``true_classes`` (G,) int64."""
    middles = (true_boxes_px[:, :2] + true_boxes_px[:, 2:]) / 2
    reach = (_CENTER_RADIUS_CELLS * strides_px)[None, :, None]
    near = ((centers_px[None] - middles[:, None]).abs() < reach).all(dim=2)
    candidates = near.any(dim=0).nonzero().squeeze(1)
    near = near[:, candidates]

    overlaps = iou(true_boxes_px[:, None], boxes_px[candidates][None])
    score = (classes[candidates].sigmoid() * objectness[candidates].sigmoid()[:, None]).sqrt()
    wanted = torch.nn.functional.one_hot(true_classes, classes.shape[1]).to(score.dtype)
    log_yes, log_no = score.clamp(min=1e-8).log(), (1 - score).clamp(min=1e-8).log()
    class_cost = -(wanted @ log_yes.T + (1 - wanted) @ log_no.T)
    cost = class_cost - _OVERLAP_WEIGHT * overlaps.clamp(min=1e-8).log() + _FAR * ~near

    takes = _cheapest(cost, overlaps * near)
    takes &= near
    contested = takes.sum(dim=0) > 1
    if contested.any():
        winner = cost[:, contested].argmin(dim=0)
        takes[:, contested] = torch.nn.functional.one_hot(winner, len(cost)).T.bool()
    objects, columns = takes.nonzero(as_tuple=True)
    return Assignment(candidates[columns], objects, overlaps[objects, columns])


def _cheapest(cost: Tensor, overlaps: Tensor) -> Tensor:
    """(G, K) which candidates each object takes: as many as its ten best overlaps add up to, at least one."""
    if not cost.shape[1]:
        return torch.zeros_like(cost, dtype=torch.bool)
    best, _ = overlaps.topk(min(_OVERLAPS_COUNTED, overlaps.shape[1]), dim=1)
    counts = best.sum(dim=1).int().clamp(min=1)
    rank = cost.argsort(dim=1, stable=True).argsort(dim=1, stable=True)
    return rank < counts[:, None]


def iou(a_px: Tensor, b_px: Tensor) -> Tensor:
    """Of boxes (..., 4) as corners that broadcast to each other."""
    sides = (torch.minimum(a_px[..., 2:], b_px[..., 2:]) - torch.maximum(a_px[..., :2], b_px[..., :2])).clamp(min=0)
    shared = sides.prod(dim=-1)
    area_a = (a_px[..., 2:] - a_px[..., :2]).prod(dim=-1)
    area_b = (b_px[..., 2:] - b_px[..., :2]).prod(dim=-1)
    return shared / (area_a + area_b - shared).clamp(min=1e-6)
