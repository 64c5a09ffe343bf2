"""3D boxes from the clusters of one camera's painted points.

LiDAR sees the sides that face the sensor, so points tell where the near sides are, and the class tells how far the
object usually reaches beyond them. What the points leave open (which axis is the length, and on which side of the
points the unseen part lies) is decided among a few hypotheses: each is projected into the image, cut by the image's
edge as the detection is, and compared with the detection's box; of those that look alike, the one wins that extends
away from the sensor.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.detection.types import Detections
from labeler.drive.types import Camera, Sweep
from labeler.geometry.boxes_3d import corners_of
from labeler.geometry.se3 import invert_se3, transform_points
from labeler.lidar.clustering import Clusters, cluster_painted_points
from labeler.lidar.config import LidarConfig, usual_sizes_m
from labeler.lidar.ground import Ground, above_ground, estimate_ground
from labeler.lidar.l_shape import extents_along, fit_yaws
from labeler.lidar.painting import View, paint_points
from labeler.lidar.types import Boxes3D

_OUTLIERS = 0.02
_LARGEST = 1.6
_LOWEST_HEIGHT = 0.8
_AWAY_BONUS = 0.2
_SIZE_PENALTY = 0.3
_POINTS_HALF_SURE = 10.0
_NEAREST_CORNER_M = 0.1
_LENGTH_ALONG, _LENGTH_ACROSS = 0, 1
_KEEP_LOW, _KEEP_MIDDLE, _KEEP_HIGH = 0, 1, 2
_OPTIONS = np.array(
    [
        (turned, along, across)
        for turned in (_LENGTH_ALONG, _LENGTH_ACROSS)
        for along in (_KEEP_LOW, _KEEP_MIDDLE, _KEEP_HIGH)
        for across in (_KEEP_LOW, _KEEP_MIDDLE, _KEEP_HIGH)
    ]
)


def boxes_from_sweep(
    sweep: Sweep,
    detections: Detections,
    camera: Camera,
    config: LidarConfig,
    *,
    class_names: tuple[str, ...],
    camera_ego_SE3_sweep_ego: NDArray[np.float64] | None = None,
    ground: Ground | None = None,
) -> Boxes3D:
    """3D boxes of what one camera detected, in the ego frame at the sweep's time, in order of the detections.

    ``class_names`` are those that ``detections.class_id`` counts in. ``camera_ego_SE3_sweep_ego`` (4, 4) maps the ego
    frame at the sweep's time to that at the image's time; identity when None. ``ground`` is that of the sweep, to be
    made once for all cameras by :func:`estimate_ground`; made here when None. A camera without calibration gets no
    boxes, and neither does a detection with fewer than ``config.min_points`` points of its own.
    """
    if camera.calibration is None or not len(detections) or not len(sweep.xyz_m):
        return Boxes3D.empty()
    view = View.of(camera, camera_ego_SE3_sweep_ego)
    painted = paint_points(sweep.xyz_m, detections, view, config)
    if ground is None:
        ground = estimate_ground(sweep.xyz_m, config)
    inside = np.abs(painted.xyz_m[:, :2]).max(axis=1, initial=0) <= config.max_distance_m
    painted = painted[inside & above_ground(painted.xyz_m, ground, config)]
    sizes_m = usual_sizes_m(detections.class_id, class_names)
    clusters = cluster_painted_points(painted, detections, sizes_m, view, config)
    return fit_boxes(clusters, detections, sizes_m, view, ground, config)


def fit_boxes(
    clusters: Clusters,
    detections: Detections,
    sizes_m: NDArray[np.float64],
    view: View,
    ground: Ground,
    config: LidarConfig,
) -> Boxes3D:
    """A box for each cluster; ``sizes_m`` (N, 3) are the usual sizes of the N detections."""
    count = len(clusters)
    if count == 0:
        return Boxes3D.empty()
    usual_m = sizes_m[clusters.detection_index]
    xy_m = clusters.points.xyz_m[:, :2]
    yaw_rad = fit_yaws(xy_m, clusters.start, config)
    low_m, high_m = extents_along(xy_m, clusters.start, yaw_rad, outliers=_OUTLIERS)
    bottom_m, top_m = _heights(clusters, usual_m, ground)
    boxes = _hypotheses(low_m, high_m, yaw_rad, bottom_m, top_m, usual_m)
    overlap = _overlap_in_image(boxes, detections.xyxy_px[clusters.detection_index], view)
    merit = overlap + _shape_merit(low_m, high_m, yaw_rad, usual_m, view.sweep_ego_SE3_camera[:2, 3])
    best = merit.argmax(axis=1)
    row = np.arange(count)
    points = clusters.num_points
    score = points / (points + _POINTS_HALF_SURE) * (1 + overlap[row, best]) / 2
    return Boxes3D(
        center_m=boxes.center_m[row, best].astype(np.float32),
        size_m=boxes.size_m[row, best].astype(np.float32),
        yaw_rad=boxes.yaw_rad[row, best].astype(np.float32),
        score=score.astype(np.float32),
        class_id=detections.class_id[clusters.detection_index].astype(np.int16),
        num_points=points.astype(np.int32),
        detection_index=clusters.detection_index,
    )


@dataclass(frozen=True, eq=False)
class _Hypotheses:
    """(C, 18) boxes, one for each row of _OPTIONS: ``center_m`` and ``size_m`` (C, 18, 3), ``yaw_rad`` (C, 18)."""

    center_m: NDArray[np.float64]
    size_m: NDArray[np.float64]
    yaw_rad: NDArray[np.float64]


def _heights(
    clusters: Clusters, usual_m: NDArray[np.float64], ground: Ground
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(C,) lowest and (C,) highest z of each object: from the ground to the points, and at least nearly as tall as
    usual, because LiDAR often misses a roof."""
    first = clusters.start[:-1]
    xyz_m = clusters.points.xyz_m.astype(np.float64)
    ground_m = ground.at(np.add.reduceat(xyz_m[:, :2], first) / clusters.num_points[:, None]).astype(np.float64)
    bottom_m = np.fmin(ground_m, np.minimum.reduceat(xyz_m[:, 2], first))
    seen_m = np.maximum.reduceat(xyz_m[:, 2], first) - bottom_m
    return bottom_m, bottom_m + np.clip(seen_m, _LOWEST_HEIGHT * usual_m[:, 2], _LARGEST * usual_m[:, 2])


def _hypotheses(
    low_m: NDArray[np.float64],
    high_m: NDArray[np.float64],
    yaw_rad: NDArray[np.float64],
    bottom_m: NDArray[np.float64],
    top_m: NDArray[np.float64],
    usual_m: NDArray[np.float64],
) -> _Hypotheses:
    """Every option for each cluster: the points' extent, filled up to the usual size on the side that is not kept."""
    usual_sides_m = np.stack([usual_m[:, :2], usual_m[:, 1::-1]], axis=1)[:, _OPTIONS[:, 0]]
    side_m = np.clip((high_m - low_m)[:, None], usual_sides_m, _LARGEST * usual_sides_m)
    kept = _OPTIONS[None, :, 1:]
    middle_m = np.where(
        kept == _KEEP_LOW,
        low_m[:, None] + side_m / 2,
        np.where(kept == _KEEP_HIGH, high_m[:, None] - side_m / 2, (low_m + high_m)[:, None] / 2),
    )
    cos, sin = np.cos(yaw_rad)[:, None], np.sin(yaw_rad)[:, None]
    x_m = cos * middle_m[..., 0] - sin * middle_m[..., 1]
    y_m = sin * middle_m[..., 0] + cos * middle_m[..., 1]
    flat = np.ones(x_m.shape)
    turned = _OPTIONS[None, :, 0] == _LENGTH_ACROSS
    center_m = np.stack([x_m, y_m, flat * (bottom_m + top_m)[:, None] / 2], axis=-1)
    length_m = np.where(turned, side_m[..., 1], side_m[..., 0])
    width_m = np.where(turned, side_m[..., 0], side_m[..., 1])
    size_m = np.stack([length_m, width_m, flat * (top_m - bottom_m)[:, None]], axis=-1)
    return _Hypotheses(center_m, size_m, yaw_rad[:, None] + np.where(turned, np.pi / 2, 0.0))


def _overlap_in_image(boxes: _Hypotheses, detected_px: NDArray[np.float32], view: View) -> NDArray[np.float64]:
    """(C, 18) intersection over union of each hypothesis, projected and cut by the image's edge, with its detection."""
    clusters, options = boxes.yaw_rad.shape
    corners_m = corners_of(boxes.center_m.reshape(-1, 3), boxes.size_m.reshape(-1, 3), boxes.yaw_rad.ravel())
    corners_camera_m = transform_points(invert_se3(view.sweep_ego_SE3_camera), corners_m.reshape(-1, 3))
    depth_m = np.maximum(corners_camera_m[:, 2:], _NEAREST_CORNER_M)
    pixel = corners_camera_m[:, :2] / depth_m @ view.intrinsics[:2, :2].T + view.intrinsics[:2, 2]
    pixel = np.clip(pixel, 0, view.size_px).reshape(clusters, options, 8, 2)
    low, high = pixel.min(axis=2), pixel.max(axis=2)
    shared = np.clip(np.minimum(high, detected_px[:, None, 2:]) - np.maximum(low, detected_px[:, None, :2]), 0, None)
    shared_px2 = shared.prod(axis=-1)
    detected_px2 = (detected_px[:, 2:] - detected_px[:, :2]).clip(0).prod(axis=-1)[:, None]
    return shared_px2 / np.maximum((high - low).prod(axis=-1) + detected_px2 - shared_px2, 1.0)


def _shape_merit(
    low_m: NDArray[np.float64],
    high_m: NDArray[np.float64],
    yaw_rad: NDArray[np.float64],
    usual_m: NDArray[np.float64],
    sensor_xy_m: NDArray[np.float64],
) -> NDArray[np.float64]:
    """(C, 18): a bonus for extending away from the sensor, less a penalty for a side that is longer than usual, or one
    that faces the sensor and yet is seen shorter than usual."""
    cos, sin = np.cos(yaw_rad), np.sin(yaw_rad)
    sensor_m = np.stack(
        [cos * sensor_xy_m[0] + sin * sensor_xy_m[1], cos * sensor_xy_m[1] - sin * sensor_xy_m[0]], axis=1
    )
    away = np.where(sensor_m < low_m, _KEEP_LOW, np.where(sensor_m > high_m, _KEEP_HIGH, _KEEP_MIDDLE))
    bonus = _AWAY_BONUS * (away[:, None] == _OPTIONS[None, :, 1:]).sum(axis=-1)
    sight = (low_m + high_m) / 2 - sensor_m
    sight /= np.maximum(np.linalg.norm(sight, axis=1, keepdims=True), 1e-9)
    faces_sensor = np.abs(sight[:, ::-1])
    usual_sides_m = np.stack([usual_m[:, :2], usual_m[:, 1::-1]], axis=1)
    ratio = (high_m - low_m)[:, None] / usual_sides_m
    penalty = (np.clip(ratio - 1, 0, None) + np.clip(1 - ratio, 0, None) * faces_sensor[:, None]).sum(axis=-1)
    return bonus - _SIZE_PENALTY * penalty[:, _OPTIONS[:, 0]]
