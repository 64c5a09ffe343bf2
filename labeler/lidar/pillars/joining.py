"""Boxes made by the network and without weights put together, and those of several cameras made one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from labeler.geometry.boxes_3d import iou_3d
from labeler.lidar.types import Boxes3D

_SAME_PLACE_IOU = 0.3
_NOT_FOUND = 0.5
"""What is left of the score of a box that the network, which saw the same points, did not find."""

_OWN = ("score", "class_id", "detection_index")
"""What each camera says for itself of an object that several see."""


def filled(found: Boxes3D, fitted: Boxes3D) -> Boxes3D:
    """The network's boxes of a camera, and for detections that it found nothing for those made without weights."""
    alone = fitted[~np.isin(fitted.detection_index, found.detection_index)]
    alone = replace(alone, score=alone.score * np.float32(_NOT_FOUND))
    boxes = Boxes3D.concatenate([found, alone])
    return boxes[np.argsort(boxes.detection_index, kind="stable")]


def seen_by_several(boxes: Mapping[str, Boxes3D]) -> dict[str, Boxes3D]:
    """Two objects can't be in one place: boxes of several cameras that overlap there become the surest of them. Each
    camera keeps its own score and class."""
    names = [name for name, of_camera in boxes.items() for _ in range(len(of_camera))]
    every = Boxes3D.concatenate(list(boxes.values()))
    taken = np.arange(len(every))
    is_free = np.ones(len(every), np.bool_)
    reach_m = np.hypot(every.size_m[:, 0], every.size_m[:, 1]) / 2
    surest_first: list[int] = np.argsort(-every.score, kind="stable").tolist()
    for row in surest_first:
        if not is_free[row]:
            continue
        is_free[row] = False
        apart_m = np.hypot(*(every.center_m[:, :2] - every.center_m[row, :2]).T)
        cameras = {names[row]}
        for other in np.flatnonzero(is_free & (apart_m < reach_m + reach_m[row])).tolist():
            if names[other] not in cameras and _bev_iou(every, row, every, other) >= _SAME_PLACE_IOU:
                cameras.add(names[other])
                is_free[other], taken[other] = False, row
    same = every[taken]
    same = replace(same, **{name: getattr(every, name) for name in _OWN})
    ends = np.cumsum([len(of_camera) for of_camera in boxes.values()])
    return {name: same[np.arange(end - len(boxes[name]), end)] for name, end in zip(boxes, ends.tolist(), strict=True)}


def _bev_iou(a: Boxes3D, row: int, b: Boxes3D, other: int) -> float:
    first = a.center_m[row], a.size_m[row], float(a.yaw_rad[row])
    return iou_3d(*first, b.center_m[other], b.size_m[other], float(b.yaw_rad[other]))[1]
