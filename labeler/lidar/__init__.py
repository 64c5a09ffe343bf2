"""Step 4a: LiDAR points painted with what a camera detected, split into objects, and boxed in 3D.

What is seen in one image and one sweep comes out as one :class:`Boxes3D`: see :func:`boxes_from_sweep`.
"""

from labeler.lidar.boxes import boxes_from_sweep, fit_boxes
from labeler.lidar.clustering import Clusters, cluster_painted_points
from labeler.lidar.config import LidarConfig, usual_sizes_m
from labeler.lidar.ground import Ground, above_ground, estimate_ground
from labeler.lidar.painting import PaintedPoints, View, paint_points
from labeler.lidar.types import Boxes3D

__all__ = [
    "Boxes3D",
    "Clusters",
    "Ground",
    "LidarConfig",
    "PaintedPoints",
    "View",
    "above_ground",
    "boxes_from_sweep",
    "cluster_painted_points",
    "estimate_ground",
    "fit_boxes",
    "paint_points",
    "usual_sizes_m",
]
