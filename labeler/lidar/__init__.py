"""Step 4a: LiDAR points painted with what cameras saw, split into objects, and boxed in 3D.

One frame goes through :func:`prepare_scene`, a :class:`BoxMaker` and :func:`find_positions`.
"""

from labeler.lidar.config import LidarConfig, usual_sizes_m
from labeler.lidar.ground import Ground, above_ground, estimate_ground
from labeler.lidar.makers import BoxMaker, CameraInput, LidarError, open_box_maker
from labeler.lidar.painting import PaintedPoints, PixelScores, View, paint_points
from labeler.lidar.positions import find_positions
from labeler.lidar.scene import Scene, prepare_scene
from labeler.lidar.types import Boxes3D, BoxSource, Positions3D, PositionSource

__all__ = [
    "BoxMaker",
    "BoxSource",
    "Boxes3D",
    "CameraInput",
    "Ground",
    "LidarConfig",
    "LidarError",
    "PaintedPoints",
    "PixelScores",
    "PositionSource",
    "Positions3D",
    "Scene",
    "View",
    "above_ground",
    "estimate_ground",
    "find_positions",
    "open_box_maker",
    "paint_points",
    "prepare_scene",
    "usual_sizes_m",
]
