"""Paint by detections: every LiDAR point takes the scores of the boxes that it projects into.

A detection's box stands in for a mask: its score, strongest in the middle of the box and weaker towards the corners,
where the background shows. A margin around each box is looked at as well, painted 0: what reaches far into it is not
the object. A point in several boxes is painted once by each; which of them it belongs to is decided
when the painted points are split into objects (:mod:`labeler.lidar.clustering`), nearer objects hiding farther ones.

Source: Vora et al., PointPainting: Sequential Fusion for 3D Object Detection, CVPR 2020.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.detection.types import Detections
from labeler.lidar.config import LidarConfig
from labeler.lidar.painting.occlusion import hidden_points
from labeler.lidar.painting.scores import PixelScores, scores_of_classes
from labeler.lidar.painting.view import View

_COARSE_PX = 8
_UNSHOWN = 0.05
"""What is left of the paint where a segmentation is sure that a pixel shows something else: it may be wrong."""


@dataclass(frozen=True, eq=False)
class PaintedPoints:
    """A row for each LiDAR point and each detection whose box, or margin, it projects into, in order of the detections.

    ``row`` (M,) int32 is the row among the points that were given, ``xyz_m`` (M, 3) float32 its place in the ego frame,
    ``pixel`` (M, 2) float32 and ``depth_m`` (M,) float32 where the camera sees it, ``detection_index`` (M,) int32 the
    row of the detection, ``score`` (M,) float32 in 0..1 the paint: 0 in the margin around the box.
    """

    row: NDArray[np.int32]
    xyz_m: NDArray[np.float32]
    pixel: NDArray[np.float32]
    depth_m: NDArray[np.float32]
    detection_index: NDArray[np.int32]
    score: NDArray[np.float32]

    def __len__(self) -> int:
        return len(self.row)

    def __getitem__(self, rows: NDArray[np.bool_] | NDArray[np.intp]) -> PaintedPoints:
        return PaintedPoints(
            self.row[rows],
            self.xyz_m[rows],
            self.pixel[rows],
            self.depth_m[rows],
            self.detection_index[rows],
            self.score[rows],
        )


def paint_points(
    xyz_m: NDArray[np.float32],
    detections: Detections,
    view: View,
    config: LidarConfig,
    *,
    class_names: tuple[str, ...] = (),
    scores: PixelScores | None = None,
) -> PaintedPoints:
    """Paint (N, 3) float32 points in the ego frame with the detections of one image.

    With the ``scores`` of a segmentation of that image a point's paint is weighted by how surely its pixel shows the
    class of the detection, one of ``class_names``. Points that are not finite, behind the camera, outside of the
    image, hidden behind nearer ones, or in and near no box of at least ``config.min_detection_score`` get no row."""
    strong = np.flatnonzero(
        (detections.score >= config.min_detection_score) & np.isfinite(detections.xyxy_px).all(axis=1)
    )
    boxes_px = detections.xyxy_px[strong].astype(np.float32)
    sight = view.see(xyz_m)
    wide_px = _widened(boxes_px, config.margin)
    sight = sight[_in_any_box(sight.pixel, wide_px, view.size_px) & ~hidden_points(sight, view)]
    box, point = pairs_inside(sight.pixel, wide_px)
    paint = detections.score[strong[box]].astype(np.float32) * mask_of_boxes(sight.pixel[point], boxes_px, box)
    if scores is not None:
        shown = scores_of_classes(scores, sight.pixel, class_names)
        paint *= _UNSHOWN + (1 - _UNSHOWN) * shown[point, detections.class_id[strong[box]]]
    return PaintedPoints(
        row=sight.row[point].astype(np.int32),
        xyz_m=xyz_m[sight.row[point]],
        pixel=sight.pixel[point],
        depth_m=sight.depth_m[point],
        detection_index=strong[box].astype(np.int32),
        score=paint,
    )


def _in_any_box(
    pixel: NDArray[np.float32], boxes_px: NDArray[np.float32], size_px: tuple[int, int]
) -> NDArray[np.bool_]:
    """(N,) bool: perhaps inside of a box: looked up in a coarse drawing of all boxes. Pixels are in the image."""
    width, height = size_px[0] // _COARSE_PX + 1, size_px[1] // _COARSE_PX + 1
    drawing = np.zeros((height, width), np.bool_)
    low = np.clip(np.floor(boxes_px[:, :2] / _COARSE_PX), 0, (width, height)).astype(int)
    high = np.clip(np.floor(boxes_px[:, 2:] / _COARSE_PX) + 1, 0, (width, height)).astype(int)
    for (x1, y1), (x2, y2) in zip(low.tolist(), high.tolist(), strict=True):
        drawing[y1:y2, x1:x2] = True
    cell = (pixel / np.float32(_COARSE_PX)).astype(np.int32)
    return drawing[cell[:, 1], cell[:, 0]]


def pairs_inside(
    pixel: NDArray[np.float32], boxes_px: NDArray[np.float32]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Every (box, point) with the point inside of the box, in order of the boxes."""
    inside = (pixel[None, :, 0] >= boxes_px[:, 0, None]) & (pixel[None, :, 0] <= boxes_px[:, 2, None])
    inside &= (pixel[None, :, 1] >= boxes_px[:, 1, None]) & (pixel[None, :, 1] <= boxes_px[:, 3, None])
    box, point = np.nonzero(inside)
    return box, point


def _widened(boxes_px: NDArray[np.float32], margin: float) -> NDArray[np.float32]:
    """The boxes with a margin on all sides, a share of the longer side."""
    longer_px = (boxes_px[:, 2:] - boxes_px[:, :2]).max(axis=1, keepdims=True, initial=0)
    return boxes_px + margin * longer_px * np.array([-1, -1, 1, 1], np.float32)


def mask_of_boxes(
    pixel: NDArray[np.float32], boxes_px: NDArray[np.float32], box: NDArray[np.intp]
) -> NDArray[np.float32]:
    """(M,) how surely a pixel shows the object: 1 in the middle of its box, exp(-2) in the corners, 0 outside."""
    middle = (boxes_px[:, :2] + boxes_px[:, 2:]) / 2
    half = np.maximum((boxes_px[:, 2:] - boxes_px[:, :2]) / 2, 0.5)
    off = np.square((pixel - middle[box]) / half[box])
    inside = (off[:, 0] <= 1) & (off[:, 1] <= 1)
    return np.where(inside, np.exp(-(off[:, 0] + off[:, 1])), np.float32(0))
