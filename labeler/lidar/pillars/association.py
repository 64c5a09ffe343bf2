"""Which detection of a camera each box of its direction belongs to.

A box is projected into the image and compared with the detections, as are the LiDAR points in it. The points decide
where an object is half hidden: detections are of the visible part, which its points lie on, while the box is of the
whole object. Boxes and detections are paired one to one, so that the sum of both agreements is highest.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from labeler.geometry.boxes_2d import iou_matrix
from labeler.geometry.boxes_3d import corners_of
from labeler.lidar.painting.view import View

_LEAST_IOU = 0.1
_LEAST_SHARE = 0.6
_MIN_DEPTH_M = 0.1


def near_detections(
    center_m: NDArray[np.float64],
    size_m: NDArray[np.float64],
    yaw_rad: NDArray[np.float64],
    detected_px: NDArray[np.float32],
    view: View,
) -> NDArray[np.intp]:
    """The rows of boxes in the ego frame that overlap a detection (D, 4) at all: no other can be associated."""
    iou = iou_matrix(projected(center_m, size_m, yaw_rad, view), detected_px)
    return np.flatnonzero((iou >= _LEAST_IOU).any(axis=1))


def associate(
    center_m: NDArray[np.float64],
    size_m: NDArray[np.float64],
    yaw_rad: NDArray[np.float64],
    points_m: Sequence[NDArray[np.float32]],
    detected_px: NDArray[np.float32],
    view: View,
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """(N,) the row of the detection of each of N boxes in the ego frame, -1 for none, and (N,) how well they agree,
    0..1. ``points_m`` are the points in each box, (K, 3); ``detected_px`` (D, 4) the detections."""
    row, merit = np.full(len(center_m), -1, np.intp), np.zeros(len(center_m))
    if not len(center_m) or not len(detected_px):
        return row, merit
    iou = iou_matrix(projected(center_m, size_m, yaw_rad, view), detected_px)
    share = np.stack([_share_inside(points, detected_px, view) for points in points_m])
    agreement = np.where((iou >= _LEAST_IOU) & (share >= _LEAST_SHARE), (iou + share) / 2, 0.0)
    boxes, detections = linear_sum_assignment(-agreement)
    paired = agreement[boxes, detections] > 0
    row[boxes[paired]] = detections[paired]
    merit[boxes[paired]] = agreement[boxes, detections][paired]
    return row, merit


def projected(
    center_m: NDArray[np.float64], size_m: NDArray[np.float64], yaw_rad: NDArray[np.float64], view: View
) -> NDArray[np.float32]:
    """(N, 4) the boxes in the image, cut by its edge."""
    corners_m = corners_of(center_m, size_m, yaw_rad).reshape(-1, 3)
    matrix = view.camera_SE3_ego
    camera_m = corners_m @ matrix[:3, :3].T + matrix[:3, 3]
    depth_m = np.maximum(camera_m[:, 2:], _MIN_DEPTH_M)
    pixel = camera_m[:, :2] / depth_m @ view.intrinsics[:2, :2].T + view.intrinsics[:2, 2]
    pixel = np.clip(pixel, 0, view.size_px).reshape(-1, 8, 2)
    return np.concatenate([pixel.min(axis=1), pixel.max(axis=1)], axis=1).astype(np.float32)


def _share_inside(points_m: NDArray[np.float32], detected_px: NDArray[np.float32], view: View) -> NDArray[np.float64]:
    """(D,) the share of those points that the image shows which lies in each detection."""
    pixel = view.see(points_m).pixel
    if not len(pixel):
        return np.zeros(len(detected_px))
    inside = (pixel[:, None] >= detected_px[None, :, :2]) & (pixel[:, None] <= detected_px[None, :, 2:])
    return inside.all(axis=2).mean(axis=0)
