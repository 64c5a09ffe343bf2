"""3D boxes without a network: painted points are split into objects, these grown, linked over cameras and boxed."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from labeler.lidar.boxes import Objects, fit_boxes
from labeler.lidar.clustering import cluster_painted_points
from labeler.lidar.config import LidarConfig, size_spreads, usual_sizes_m
from labeler.lidar.growth import CameraClusters, grow_clusters, link_clusters
from labeler.lidar.makers import CameraInput
from labeler.lidar.painting.by_boxes import paint_points
from labeler.lidar.scene import Scene
from labeler.lidar.types import Boxes3D


class ClusterBoxMaker:
    """The method "clusters": needs no weights."""

    def __init__(self, config: LidarConfig, *, class_names: tuple[str, ...]) -> None:
        self._config = config
        self._class_names = class_names

    def boxes(self, scene: Scene, cameras: Mapping[str, CameraInput]) -> dict[str, Boxes3D]:
        """As :class:`labeler.lidar.makers.BoxMaker` has it. A detection with fewer than ``config.min_points`` points
        of its own gets no box."""
        xyz_m = scene.xyz_m[scene.clear]
        clusters = {name: self._clusters(xyz_m, camera) for name, camera in cameras.items() if len(camera.detections)}
        clusters = grow_clusters(clusters, xyz_m, self._config)
        objects = Objects.of(link_clusters(clusters, len(xyz_m)), clusters)
        boxes = fit_boxes(objects, clusters, scene, self._config)
        return {name: boxes.get(name, Boxes3D.empty()) for name in cameras}

    def _clusters(self, xyz_m: NDArray[np.float32], camera: CameraInput) -> CameraClusters:
        detections, view = camera.detections, camera.view
        painted = paint_points(
            xyz_m, detections, view, self._config, class_names=self._class_names, scores=camera.scores
        )
        sizes_m = usual_sizes_m(detections.class_id, self._class_names)
        clusters = cluster_painted_points(painted, detections, sizes_m, view, self._config)
        return CameraClusters(view, detections, sizes_m, size_spreads(detections.class_id, self._class_names), clusters)
