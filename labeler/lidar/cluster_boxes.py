"""3D boxes without a network: painted points are split into objects, these grown, linked over cameras and boxed."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from labeler.lidar.boxes import Objects, fit_boxes
from labeler.lidar.clustering import cluster_painted_points, components_of
from labeler.lidar.config import LidarConfig, size_spreads, usual_sizes_m
from labeler.lidar.growth import CameraClusters, grow_clusters, link_clusters
from labeler.lidar.makers import CameraInput
from labeler.lidar.painting.by_boxes import PaintedPoints, paint_points
from labeler.lidar.scene import Scene
from labeler.lidar.types import Boxes3D


class ClusterBoxMaker:
    """The method "clusters": needs no weights, and no segmentation, though one helps."""

    takes_paint = False

    def __init__(self, config: LidarConfig, *, class_names: tuple[str, ...]) -> None:
        self._config = config
        self._class_names = class_names

    def boxes(self, scene: Scene, cameras: Mapping[str, CameraInput]) -> dict[str, Boxes3D]:
        """As :class:`labeler.lidar.makers.BoxMaker` has it. A detection with fewer than ``config.min_points`` points
        of its own gets no box."""
        xyz_m = scene.clear_xyz_m
        clusters = grow_clusters(self._clusters(xyz_m, cameras), xyz_m, self._config)
        objects = Objects.of(link_clusters(clusters, len(xyz_m)), clusters)
        boxes = fit_boxes(objects, clusters, scene, self._config)
        found = {name: boxes.get(name, Boxes3D.empty()) for name in cameras}
        return {name: own[own.score >= self._config.min_box_score] for name, own in found.items()}

    def _clusters(self, xyz_m: NDArray[np.float32], cameras: Mapping[str, CameraInput]) -> dict[str, CameraClusters]:
        """The clusters of each camera that has detections, of the points that it painted."""
        names = [name for name, camera in cameras.items() if len(camera.detections)]
        painted = [self._paint(xyz_m, cameras[name]) for name in names]
        clusters: dict[str, CameraClusters] = {}
        for name, points, around in zip(names, painted, components_of(painted, self._config), strict=True):
            detections, view = cameras[name].detections, cameras[name].view
            sizes_m = usual_sizes_m(detections.class_id, self._class_names)
            spreads = size_spreads(detections.class_id, self._class_names)
            found = cluster_painted_points(points, around, detections, sizes_m, view, self._config)
            clusters[name] = CameraClusters(view, detections, sizes_m, spreads, found)
        return clusters

    def _paint(self, xyz_m: NDArray[np.float32], camera: CameraInput) -> PaintedPoints:
        return paint_points(
            xyz_m,
            camera.detections,
            camera.view,
            self._config,
            class_names=self._class_names,
            scores=camera.scores,
        )
