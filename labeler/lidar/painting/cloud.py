"""A whole cloud painted by one image, as PointPainting's networks take it: x, y, z, intensity, a score for each class.

The scores come from a segmentation of the image where there is one, else from the detections: a box stands in for a
mask. A point that the image does not show, because it lies outside or is hidden behind a nearer one, has scores of 0.
Each camera direction has its own cloud, so a point that two cameras see has the paint of both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.detection.types import Detections
from labeler.lidar.config import LidarConfig
from labeler.lidar.painting.by_boxes import mask_of_boxes, pairs_inside
from labeler.lidar.painting.occlusion import hidden_points
from labeler.lidar.painting.scores import PixelScores, scores_of_classes
from labeler.lidar.painting.view import View

POINT_COLUMNS = 4
"""x, y, z and intensity come before the scores."""


@dataclass(frozen=True, eq=False)
class PaintedCloud:
    """``points`` (N, 4 + C) float32: x, y, z in metres in the ego frame at the frame's time, intensity as recorded, and
    a score in 0..1 for each of C ``class_names``. ``seen`` (N,) bool: the image shows the point."""

    points: NDArray[np.float32]
    class_names: tuple[str, ...]
    seen: NDArray[np.bool_]


def paint_cloud(
    xyz_m: NDArray[np.float32],
    intensity: NDArray[np.float32],
    view: View,
    *,
    painted_classes: Sequence[str],
    detections: Detections,
    class_names: Sequence[str],
    scores: PixelScores | None,
    config: LidarConfig,
) -> PaintedCloud:
    """Paint (N, 3) points of a sweep, in the ego frame at the frame's time, with one image.

    ``painted_classes`` are the columns to paint, by name. With ``scores`` they are read from that segmentation, where
    "vehicle" and the classes of vehicles stand for one another and a class that it does not know is not painted. With
    None, a column has the surest of the detections of its class (``class_names`` are what their ``class_id`` counts in)
    in whose box a point lies, weaker towards the box's corners.
    """
    points = np.zeros((len(xyz_m), POINT_COLUMNS + len(painted_classes)), np.float32)
    points[:, :3], points[:, 3] = xyz_m, intensity
    sight = view.see(xyz_m)
    sight = sight[~hidden_points(sight, view)]
    if scores is not None:
        paint = scores_of_classes(scores, sight.pixel, painted_classes, unknown=0.0)
    else:
        paint = _paint_of_boxes(sight.pixel, detections, painted_classes, class_names, config)
    points[sight.row, POINT_COLUMNS:] = paint
    seen = np.zeros(len(xyz_m), np.bool_)
    seen[sight.row] = True
    return PaintedCloud(points, tuple(painted_classes), seen)


def _paint_of_boxes(
    pixel: NDArray[np.float32],
    detections: Detections,
    painted_classes: Sequence[str],
    class_names: Sequence[str],
    config: LidarConfig,
) -> NDArray[np.float32]:
    """(M, C) the surest detection's score times its mask."""
    paint = np.zeros((len(pixel), len(painted_classes)), np.float32)
    column_of = {name: column for column, name in enumerate(painted_classes)}
    column_of_class = np.array([*(column_of.get(name, -1) for name in class_names), -1], np.intp)
    columns = column_of_class[detections.class_id]
    strong = np.flatnonzero(
        (detections.score >= config.min_detection_score) & np.isfinite(detections.xyxy_px).all(axis=1) & (columns >= 0)
    )
    boxes_px = detections.xyxy_px[strong].astype(np.float32)
    box, point = pairs_inside(pixel, boxes_px)
    value = detections.score[strong[box]].astype(np.float32) * mask_of_boxes(pixel[point], boxes_px, box)
    np.maximum.at(paint, (point, columns[strong[box]]), value)
    return paint
