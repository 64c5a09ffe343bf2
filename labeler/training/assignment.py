"""Which cells of the YOLOX output learn which object: SimOTA (arXiv:2107.08430, section 2.1), for a batch at once.

Cells near an object's middle are candidates. An object takes as many of them as its best overlaps add up to, the
cheapest first, where the cost is that of the class and of the overlap; a cell wanted by two goes to the cheaper one.

Images hold different numbers of objects, and objects have different numbers of candidates. All are filled up to the
same number and a mask says what is real, so that no size depends on a value: a GPU never has to be waited for.
"""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

_CENTER_RADIUS_CELLS = 1.5
_MOST_NEAR = 27
"""Three by three cells of each of three strides lie within the radius of a middle."""
_OVERLAP_WEIGHT = 3.0
_OVERLAPS_COUNTED = 10
_FAR = 1e6


@dataclass(frozen=True, eq=False)
class Assignment:
    """For each of G objects of N images its K candidates: ``cells`` (N, G, K) int64 rows of the output, ``takes``
    (N, G, K) bool which of them learn the object (a cell learns one at most; where it is False the cell means nothing),
    ``overlaps`` (N, G, K) float32 the IoU of what the cell predicts now with the object."""

    cells: Tensor
    takes: Tensor
    overlaps: Tensor

    def of_cells(self, values: Tensor) -> Tensor:
        """(N, G, K, C) what ``values`` (N, A, C) has in the cells."""
        index = self.cells.flatten(1)[..., None].expand(-1, -1, values.shape[2])
        return values.gather(1, index).reshape(*self.cells.shape, values.shape[2])


@torch.no_grad()
def assign(
    boxes_px: Tensor, objectness: Tensor, classes: Tensor, centers_px: Tensor, strides_px: Tensor,
    true_boxes_px: Tensor, true_classes: Tensor, is_there: Tensor,
) -> Assignment:  # fmt: skip
    """Predicted ``boxes_px`` (N, A, 4) as corners, logits of ``objectness`` (N, A) and ``classes`` (N, A, C), the
    cells' ``centers_px`` (A, 2) and ``strides_px`` (A,), and the objects, ``true_boxes_px`` (N, G, 4) and
    ``true_classes`` (N, G) int64, of which only those that ``is_there`` (N, G) bool are real."""
    middles = (true_boxes_px[..., :2] + true_boxes_px[..., 2:]) / 2
    reach = _CENTER_RADIUS_CELLS * strides_px
    is_near = is_there[..., None]
    for axis in (0, 1):
        is_near = is_near & ((centers_px[:, axis] - middles[..., axis, None]).abs() < reach)
    cells, near = _first_true(is_near)
    found = Assignment(cells, near, overlaps=torch.empty(0))

    overlaps = iou(true_boxes_px[:, :, None], found.of_cells(boxes_px))
    score = (found.of_cells(classes).sigmoid() * found.of_cells(objectness[..., None]).sigmoid()).sqrt()
    wanted = one_of(true_classes, classes.shape[2])[:, :, None]
    chance = torch.where(wanted, score, 1 - score).clamp(min=1e-8)
    cost = -chance.log().sum(dim=3) - _OVERLAP_WEIGHT * overlaps.clamp(min=1e-8).log() + _FAR * ~near

    takes = _cheapest(cost, overlaps * near) & near
    return Assignment(cells, _without_contests(cells, takes, near, cost, boxes_px.shape[1]), overlaps)


def _first_true(is_near: Tensor) -> tuple[Tensor, Tensor]:
    """(N, G, K) the places of the first True of each row of (N, G, A), in order, and whether there is one."""
    count = is_near.shape[2]
    order = torch.arange(count, 0, -1, device=is_near.device, dtype=torch.float32)
    values, places = (is_near * order).topk(min(_MOST_NEAR, count), dim=2)
    return places, values > 0


def _cheapest(cost: Tensor, overlaps: Tensor) -> Tensor:
    """(N, G, K) which candidates each object takes: as many as its ten best overlaps add up to, at least one."""
    best, _ = overlaps.topk(min(_OVERLAPS_COUNTED, overlaps.shape[2]), dim=2)
    counts = best.sum(dim=2).int().clamp(min=1)
    rank = cost.argsort(dim=2, stable=True).argsort(dim=2, stable=True)
    return rank < counts[..., None]


def _without_contests(cells: Tensor, takes: Tensor, near: Tensor, cost: Tensor, cell_count: int) -> Tensor:
    """(N, G, K) the same, but a cell that several take goes to the one for which it is cheapest of all that it is near
    to, the first of equals."""
    images, objects, _ = cells.shape
    flat = cells.flatten(1)

    def least(values: Tensor, most: float) -> Tensor:
        """The least of all that are said of the same cell."""
        table = torch.full((images, cell_count), most, dtype=values.dtype, device=values.device)
        return table.scatter_reduce(1, flat, values.flatten(1), "amin").gather(1, flat).reshape(cells.shape)

    wanted = torch.zeros((images, cell_count), device=cells.device)
    is_contested = (wanted.scatter_add(1, flat, takes.flatten(1).float()) > 1).gather(1, flat).reshape(cells.shape)
    is_cheapest = near & (cost == least(cost, torch.inf))
    number = torch.arange(objects, device=cells.device)[None, :, None].expand_as(cells)
    wins = is_cheapest & (number == least(torch.where(is_cheapest, number, objects), objects))
    return torch.where(is_contested, wins, takes)


def one_of(classes: Tensor, count: int) -> Tensor:
    """(..., count) bool, True at the class."""
    return classes[..., None] == torch.arange(count, device=classes.device)


def iou(a_px: Tensor, b_px: Tensor) -> Tensor:
    """Of boxes (..., 4) as corners that broadcast to each other."""
    sides = (torch.minimum(a_px[..., 2:], b_px[..., 2:]) - torch.maximum(a_px[..., :2], b_px[..., :2])).clamp(min=0)
    shared = sides.prod(dim=-1)
    area_a = (a_px[..., 2:] - a_px[..., :2]).prod(dim=-1)
    area_b = (b_px[..., 2:] - b_px[..., :2]).prod(dim=-1)
    return shared / (area_a + area_b - shared).clamp(min=1e-6)
