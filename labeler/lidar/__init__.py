"""Step 4a: LiDAR points painted with what cameras saw, split into objects, and boxed in 3D.

One frame goes through :func:`prepare_scene`, a :class:`BoxMaker` and :func:`find_positions`.
"""

from labeler.lidar.agreement import Agreement, calibration_warnings, measure_agreement
from labeler.lidar.config import LidarConfig, usual_sizes_m
from labeler.lidar.ground import Ground, above_ground, estimate_ground
from labeler.lidar.makers import BoxMaker, CameraInput, LidarError, open_box_maker, takes_paint
from labeler.lidar.over_time import refine_track_boxes
from labeler.lidar.painting import PaintedCloud, PaintedPoints, PixelScores, View, paint_cloud, paint_points
from labeler.lidar.positions import find_positions
from labeler.lidar.scene import Scene, prepare_scene
from labeler.lidar.types import Boxes3D, BoxSource, Positions3D, PositionSource

__all__ = [
    "Agreement",
    "BoxMaker",
    "BoxSource",
    "Boxes3D",
    "CameraInput",
    "Ground",
    "LidarConfig",
    "LidarError",
    "PaintedCloud",
    "PaintedPoints",
    "PixelScores",
    "PositionSource",
    "Positions3D",
    "Scene",
    "View",
    "above_ground",
    "calibration_warnings",
    "estimate_ground",
    "find_positions",
    "measure_agreement",
    "open_box_maker",
    "paint_cloud",
    "paint_points",
    "prepare_scene",
    "refine_track_boxes",
    "takes_paint",
    "usual_sizes_m",
]
