"""3D boxes by the pillar network, direction by direction; the method "pillars".

A detection that the network has no box for (too far, too few points, a class that it was not taught) gets the box made
without weights, and so do those of a camera without a segmentation, where the network takes painted points.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from labeler.lidar.cluster_boxes import ClusterBoxMaker
from labeler.lidar.config import LidarConfig
from labeler.lidar.makers import CameraInput, LidarError
from labeler.lidar.painting.view import View
from labeler.lidar.pillars.association import associate, near_detections
from labeler.lidar.pillars.decode import PillarBoxes
from labeler.lidar.pillars.direction import Direction, direction_cloud
from labeler.lidar.pillars.joining import filled, seen_by_several
from labeler.lidar.pillars.network import PillarModel
from labeler.lidar.scene import Scene
from labeler.lidar.types import Boxes3D, BoxSource
from labeler.models import SHIPPED, Task

_NEAR_BOX_M = 0.15
_CELLS_AROUND = 20
"""How far points are looked at beyond the network's grid: a box whose middle lies in it may reach out."""


class PillarBoxMaker:
    """The method "pillars"."""

    def __init__(self, config: LidarConfig, *, class_names: tuple[str, ...]) -> None:
        """``config.network`` is the network's file, None for the one that ships. ModelError when it can't be used."""
        self._config = config
        self._model = _opened(Path(config.network) if config.network else shipped_network())
        self._class_names = class_names
        known = {name: number for number, name in enumerate(class_names)}
        self._class_of = np.array([known.get(name, -1) for name in self._model.class_names], np.int16)
        self._without_weights = ClusterBoxMaker(config, class_names=class_names)

    @property
    def takes_paint(self) -> bool:
        return self._model.painted

    def boxes(self, scene: Scene, cameras: Mapping[str, CameraInput]) -> dict[str, Boxes3D]:
        """As :class:`labeler.lidar.makers.BoxMaker` has it."""
        found = {name: self._of_direction(scene, camera) for name, camera in cameras.items()}
        if not self._config.fill:
            return seen_by_several(found)
        fitted = self._without_weights.boxes(scene, cameras)
        return seen_by_several({name: filled(found[name], fitted[name]) for name in cameras})

    def _of_direction(self, scene: Scene, camera: CameraInput) -> Boxes3D:
        """The network's boxes of a direction that belong to a detection."""
        if not len(camera.detections) or not len(scene.clear) or (self._model.painted and camera.scores is None):
            return Boxes3D.empty()
        view, detected_px = camera.view, camera.detections.xyxy_px
        around = self._model.grid.widened(_CELLS_AROUND)
        cloud, rows = direction_cloud(scene, view, camera.scores, self._config, within=around)
        found = self._model.find(cloud, min_score=self._config.min_box_score)
        if not len(found):
            return Boxes3D.empty()
        center_m, yaw_rad = _in_ego(found, view, scene)
        near = near_detections(center_m, found.size_m, yaw_rad, detected_px, view)
        found, center_m, yaw_rad = found[near], center_m[near], yaw_rad[near]
        held = _held(cloud, found)
        points_m = [scene.xyz_m[rows[inside]] for inside in held]
        detection, _ = associate(center_m, found.size_m, yaw_rad, points_m, detected_px, view)
        chosen: NDArray[np.intp] = np.flatnonzero(detection >= 0)
        chosen = chosen[np.argsort(detection[chosen], kind="stable")]
        numbers: list[int] = chosen.tolist()
        kept = [held[row] for row in numbers]
        extents = [_extent(cloud[inside], found, row) for row, inside in zip(numbers, kept, strict=True)]
        of_class = self._class_of[found.class_index[chosen]]
        return Boxes3D(
            center_m=center_m[chosen].astype(np.float32),
            size_m=found.size_m[chosen].astype(np.float32),
            yaw_rad=((yaw_rad[chosen] + np.pi) % (2 * np.pi) - np.pi).astype(np.float32),
            score=found.score[chosen].astype(np.float32),
            class_id=np.where(of_class >= 0, of_class, camera.detections.class_id[detection[chosen]]).astype(np.int16),
            num_points=np.array([len(inside) for inside in kept], np.int32),
            detection_index=detection[chosen].astype(np.int32),
            source=np.full(len(chosen), BoxSource.PILLARS, np.int8),
            center_std_m=found.std[chosen, :2].astype(np.float32),
            yaw_std_rad=found.std[chosen, 2].astype(np.float32),
            seen_m=np.array(extents, np.float32).reshape(-1, 4),
            offset_s=np.array([scene.offset_s[rows[inside]].mean() for inside in kept], np.float32),
        )


def shipped_network() -> Path:
    """The pillar network that ships. LidarError where none does."""
    for model in SHIPPED:
        if model.task is Task.BOXES:
            return model.path
    raise LidarError("No pillar network ships with this version. Name a file: hindsight train pillars makes one.")


@cache
def _opened(path: Path) -> PillarModel:
    """Opening takes longer than a clip of frames."""
    return PillarModel(path)


def _in_ego(found: PillarBoxes, view: View, scene: Scene) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(N, 3) centres in the ego frame and (N,) yaws of the boxes of a view's direction."""
    direction = Direction.of(view)
    xy_m = direction.to_ego(found.center_m[:, :2])
    center_m = np.concatenate([xy_m, found.center_m[:, 2:] + scene.ground.at(xy_m)[:, None]], axis=1)
    return center_m, found.yaw_rad + direction.yaw_rad


def _held(cloud: NDArray[np.float32], boxes: PillarBoxes) -> list[NDArray[np.intp]]:
    """The rows of the cloud in each box, or within a hand's breadth of it."""
    x_m, y_m = np.ascontiguousarray(cloud[:, 0]), np.ascontiguousarray(cloud[:, 1])
    held: list[NDArray[np.intp]] = []
    for row in range(len(boxes)):
        half_m = boxes.size_m[row] / 2 + _NEAR_BOX_M
        (middle_x, middle_y), reach_m = boxes.center_m[row, :2].tolist(), float(np.hypot(half_m[0], half_m[1]))
        near = np.flatnonzero((np.abs(x_m - middle_x) <= reach_m) & (np.abs(y_m - middle_y) <= reach_m))
        along_m, across_m = _in_box_axes(cloud[near, :2], boxes, row)
        inside = (np.abs(along_m) <= half_m[0]) & (np.abs(across_m) <= half_m[1])
        inside &= np.abs(cloud[near, 2] - boxes.center_m[row, 2]) <= half_m[2]
        held.append(near[inside])
    return held


def _in_box_axes(
    xy_m: NDArray[np.float32], boxes: PillarBoxes, row: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    off_m = xy_m - boxes.center_m[row, :2]
    cos, sin = np.cos(boxes.yaw_rad[row]), np.sin(boxes.yaw_rad[row])
    return cos * off_m[:, 0] + sin * off_m[:, 1], cos * off_m[:, 1] - sin * off_m[:, 0]


def _extent(cloud: NDArray[np.float32], boxes: PillarBoxes, row: int) -> list[float]:
    """How far the points reach from the centre in the box's axes: lowest along and across, highest along and across."""
    along_m, across_m = _in_box_axes(cloud[:, :2], boxes, row)
    return [float(along_m.min()), float(across_m.min()), float(along_m.max()), float(across_m.max())]
