"""Points take from an image what it says about them (PointPainting).

:func:`paint_points` paints with detections, for splitting points into objects; :func:`paint_cloud` gives a whole cloud
a score for each class, as a network takes it.

Source: Vora et al., PointPainting: Sequential Fusion for 3D Object Detection, CVPR 2020.
"""

from labeler.lidar.painting.by_boxes import PaintedPoints, paint_points
from labeler.lidar.painting.cloud import PaintedCloud, paint_cloud
from labeler.lidar.painting.scores import PixelScores
from labeler.lidar.painting.view import Sight, View

__all__ = ["PaintedCloud", "PaintedPoints", "PixelScores", "Sight", "View", "paint_cloud", "paint_points"]
