"""Are two 3D boxes at the same place? Two objects can't be, so boxes at the same place are one object."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.geometry.boxes_3d import iou_3d
from labeler.lidar.types import Boxes3D


@dataclass(frozen=True)
class BoxPair:
    """Row ``a`` of one camera's boxes and row ``b`` of another's are at the same place. ``similarity`` is in 0..1."""

    a: int
    b: int
    similarity: float
    distance_m: float
    bev_iou: float
    iou_3d: float


def compare_boxes(boxes_a: Boxes3D, a: int, boxes_b: Boxes3D, b: int) -> BoxPair:
    """How close two boxes are. The similarity is the bird's-eye IoU, or, if that is more, how little their centres are
    apart seen from above, measured in widths: a yaw that was fitted wrongly by a quarter turn spoils the former only.
    """
    volume_iou, bev_iou = iou_3d(
        boxes_a.center_m[a], boxes_a.size_m[a], float(boxes_a.yaw_rad[a]),
        boxes_b.center_m[b], boxes_b.size_m[b], float(boxes_b.yaw_rad[b]),
    )  # fmt: skip
    distance_m = float(np.linalg.norm(boxes_a.center_m[a, :2] - boxes_b.center_m[b, :2]))
    width_m = float(boxes_a.size_m[a, :2].min() + boxes_b.size_m[b, :2].min()) / 2
    nearness = max(0.0, 1 - distance_m / width_m) if width_m > 0 else 0.0
    return BoxPair(a, b, max(bev_iou, nearness), distance_m, bev_iou, volume_iou)


def boxes_at_same_place(
    boxes_a: Boxes3D,
    boxes_b: Boxes3D,
    allowed: NDArray[np.bool_],
    min_similarity: float,
) -> list[BoxPair]:
    """The pairs of boxes at the same place, each box in one pair at most, the most similar first.

    ``allowed`` (A, B) bool says which pairs may be one object at all. Boxes whose heights don't overlap are not."""
    if not len(boxes_a) or not len(boxes_b):
        return []
    apart_m = np.linalg.norm(boxes_a.center_m[:, None, :2] - boxes_b.center_m[None, :, :2], axis=2)
    reach_m = (_reach_m(boxes_a)[:, None] + _reach_m(boxes_b)[None, :]) / 2
    stacked_m = np.abs(boxes_a.center_m[:, None, 2] - boxes_b.center_m[None, :, 2])
    tall_m = (boxes_a.size_m[:, None, 2] + boxes_b.size_m[None, :, 2]) / 2
    near = np.argwhere(allowed & (apart_m < reach_m) & (stacked_m < tall_m))
    pairs = [compare_boxes(boxes_a, int(a), boxes_b, int(b)) for a, b in near]
    taken_a: set[int] = set()
    taken_b: set[int] = set()
    best: list[BoxPair] = []
    for pair in sorted(pairs, key=lambda pair: (-pair.similarity, pair.a, pair.b)):
        if pair.similarity < min_similarity:
            break
        if pair.a not in taken_a and pair.b not in taken_b:
            best.append(pair)
            taken_a.add(pair.a)
            taken_b.add(pair.b)
    return best


def _reach_m(boxes: Boxes3D) -> NDArray[np.floating]:
    return np.linalg.norm(boxes.size_m[:, :2], axis=1)
