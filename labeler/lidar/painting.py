"""PointPainting with boxes for a segmentation: every LiDAR point takes the scores of the boxes that it projects into.

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
from labeler.drive.types import Camera
from labeler.geometry.projection import project_points
from labeler.geometry.se3 import invert_se3
from labeler.lidar.config import LidarConfig

_MIN_DEPTH_M = 0.5
_COARSE_PX = 8


@dataclass(frozen=True, eq=False)
class View:
    """A camera as the sweep sees it: ``sweep_ego_SE3_camera`` (4, 4) from the camera at the image's time to the ego
    frame at the sweep's time, ``intrinsics`` (3, 3) in pixels, ``size_px`` width and height of the image."""

    sweep_ego_SE3_camera: NDArray[np.float64]
    intrinsics: NDArray[np.float64]
    size_px: tuple[int, int]

    @staticmethod
    def of(camera: Camera, camera_ego_SE3_sweep_ego: NDArray[np.float64] | None = None) -> View:
        """The view of a camera; ``camera_ego_SE3_sweep_ego`` (4, 4) maps the ego frame at the sweep's time to that at
        the image's time, identity when None. ValueError when the camera has no calibration."""
        if camera.calibration is None:
            raise ValueError(f"camera {camera.name} has no calibration: no point can be projected into it")
        ego_SE3_camera = camera.calibration.ego_SE3_camera
        if camera_ego_SE3_sweep_ego is not None:
            ego_SE3_camera = invert_se3(camera_ego_SE3_sweep_ego) @ ego_SE3_camera
        return View(ego_SE3_camera, camera.calibration.intrinsics, (camera.width_px, camera.height_px))


@dataclass(frozen=True, eq=False)
class PaintedPoints:
    """A row for each LiDAR point and each detection whose box, or margin, it projects into, in order of the detections.

    ``row`` (M,) int32 is the point's row in the sweep, ``xyz_m`` (M, 3) float32 its place in the ego frame,
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


def paint_points(xyz_m: NDArray[np.float32], detections: Detections, view: View, config: LidarConfig) -> PaintedPoints:
    """Paint (N, 3) float32 points of a sweep, in the ego frame, with the detections of one image.

    Points that are not finite, behind the camera, outside of the image, or in and near no box of at least
    ``config.min_detection_score`` get no row."""
    strong = np.flatnonzero(
        (detections.score >= config.min_detection_score) & np.isfinite(detections.xyxy_px).all(axis=1)
    )
    boxes_px = detections.xyxy_px[strong].astype(np.float32)
    seen = _rows_in_front(xyz_m, view)
    pixel, depth_m = project_points(xyz_m[seen], view.sweep_ego_SE3_camera, view.intrinsics)
    wide_px = _widened(boxes_px, config.margin)
    covered = _in_any_box(pixel, wide_px, view.size_px)
    seen, pixel, depth_m = seen[covered], pixel[covered].astype(np.float32), depth_m[covered].astype(np.float32)
    box, point = _pairs(pixel, wide_px)
    return PaintedPoints(
        row=seen[point].astype(np.int32),
        xyz_m=xyz_m[seen[point]],
        pixel=pixel[point],
        depth_m=depth_m[point],
        detection_index=strong[box].astype(np.int32),
        score=detections.score[strong[box]].astype(np.float32) * _mask(pixel[point], boxes_px, box),
    )


def _rows_in_front(xyz_m: NDArray[np.float32], view: View) -> NDArray[np.intp]:
    """Rows of the points in the cone that holds the image; a cheap cut before the exact projection."""
    camera_SE3_ego = invert_se3(view.sweep_ego_SE3_camera).astype(np.float32)
    with np.errstate(invalid="ignore"):  # a point that is not finite gets a depth that is not, and is cut
        depth_m = xyz_m @ camera_SE3_ego[2, :3] + camera_SE3_ego[2, 3]
        aside_m = xyz_m @ camera_SE3_ego[0, :3] + camera_SE3_ego[0, 3]
    width_px, focal_px, middle_px = view.size_px[0], view.intrinsics[0, 0], view.intrinsics[0, 2]
    right, left = (width_px - middle_px) / focal_px + 0.01, middle_px / focal_px + 0.01
    inside = (depth_m > _MIN_DEPTH_M) & (depth_m < np.inf) & (aside_m <= right * depth_m) & (aside_m >= -left * depth_m)
    rows = np.flatnonzero(inside)
    return rows[np.isfinite(xyz_m[rows]).all(axis=1)]


def _in_any_box(
    pixel: NDArray[np.float64], boxes_px: NDArray[np.float32], size_px: tuple[int, int]
) -> NDArray[np.bool_]:
    """(N,) bool: inside of the image, and perhaps inside of a box: looked up in a coarse drawing of all boxes."""
    width, height = size_px[0] // _COARSE_PX + 1, size_px[1] // _COARSE_PX + 1
    drawing = np.zeros((height, width), np.bool_)
    low = np.clip(np.floor(boxes_px[:, :2] / _COARSE_PX), 0, (width, height)).astype(int)
    high = np.clip(np.floor(boxes_px[:, 2:] / _COARSE_PX) + 1, 0, (width, height)).astype(int)
    for (x1, y1), (x2, y2) in zip(low.tolist(), high.tolist(), strict=True):
        drawing[y1:y2, x1:x2] = True
    x, y = pixel[:, 0], pixel[:, 1]
    inside = (x >= 0) & (y >= 0) & (x < size_px[0]) & (y < size_px[1])
    covered = np.zeros(len(pixel), np.bool_)
    covered[inside] = drawing[y[inside].astype(np.intp) // _COARSE_PX, x[inside].astype(np.intp) // _COARSE_PX]
    return covered


def _pairs(pixel: NDArray[np.float32], boxes_px: NDArray[np.float32]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Every (box, point) with the point inside of the box, in order of the boxes."""
    inside = (pixel[None, :, 0] >= boxes_px[:, 0, None]) & (pixel[None, :, 0] <= boxes_px[:, 2, None])
    inside &= (pixel[None, :, 1] >= boxes_px[:, 1, None]) & (pixel[None, :, 1] <= boxes_px[:, 3, None])
    box, point = np.nonzero(inside)
    return box, point


def _widened(boxes_px: NDArray[np.float32], margin: float) -> NDArray[np.float32]:
    """The boxes with a margin on all sides, a share of the longer side."""
    longer_px = (boxes_px[:, 2:] - boxes_px[:, :2]).max(axis=1, keepdims=True, initial=0)
    return boxes_px + margin * longer_px * np.array([-1, -1, 1, 1], np.float32)


def _mask(pixel: NDArray[np.float32], boxes_px: NDArray[np.float32], box: NDArray[np.intp]) -> NDArray[np.float32]:
    """(M,) how surely a pixel shows the object: 1 in the middle of its box, exp(-2) in the corners, 0 outside."""
    middle = (boxes_px[:, :2] + boxes_px[:, 2:]) / 2
    half = np.maximum((boxes_px[:, 2:] - boxes_px[:, :2]) / 2, 0.5)
    off = np.square((pixel - middle[box]) / half[box])
    inside = (off[:, 0] <= 1) & (off[:, 1] <= 1)
    return np.where(inside, np.exp(-(off[:, 0] + off[:, 1])), np.float32(0))
