"""3D boxes from the clusters of one camera's painted points.

LiDAR sees the sides that face the sensor, so points tell where the near sides are, and the class tells how far the
object usually reaches beyond them. What the points leave open (which axis is the length, and on which side of the
points the unseen part lies) is decided among a few hypotheses: each is projected into the image, cut by the image's
edge as the detection is, and compared with the detection's box; of those that look alike, the one wins that extends
away from the sensor.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.geometry.boxes_3d import corners_of
from labeler.geometry.se3 import transform_points
from labeler.lidar.clustering import Clusters
from labeler.lidar.config import LidarConfig
from labeler.lidar.ground import Ground
from labeler.lidar.growth import CameraClusters, Member
from labeler.lidar.l_shape import extents_along, fit_yaws
from labeler.lidar.painting.view import View
from labeler.lidar.scene import Scene
from labeler.lidar.types import Boxes3D, BoxSource

_OUTLIERS = 0.02
_LARGEST_SPREADS = 5.0
"""An object is larger than usual by at most so many times what its class differs by."""
_LOWEST_HEIGHT = 0.8
_AWAY_BONUS = 0.2
_SIZE_PENALTY = 0.3
_POINTS_HALF_SURE = 10.0
_NEAREST_CORNER_M = 0.1
_SOFTNESS = 0.1
_POSITION_NOISE_M = 0.1
_LEAST_YAW_STD_RAD = 0.03
_YAW_STD_M = 0.5
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


@dataclass(frozen=True, eq=False)
class Objects:
    """Objects to box: the points of each, ``start[i]:start[i + 1]`` of (P,) ``row`` in ``xyz_m``; ``usual_m`` (C, 3)
    the size that its class usually has; ``members`` the cameras' clusters that show it."""

    row: NDArray[np.int32]
    start: NDArray[np.int64]
    usual_m: NDArray[np.float64]
    spread: NDArray[np.float64]
    members: Sequence[Sequence[Member]]

    def __len__(self) -> int:
        return len(self.members)

    @staticmethod
    def of(groups: Sequence[Sequence[Member]], cameras: Mapping[str, CameraClusters]) -> Objects:
        """An object for each group of clusters: all of their points, and the size of the surest detection's class."""
        rows_of: dict[int, NDArray[np.int32]] = {}
        usual_m, spread = np.zeros((len(groups), 3)), np.zeros((len(groups), 3))
        for number, group in enumerate(groups):
            rows_of[number] = np.unique(
                np.concatenate([cameras[name].clusters.rows_of(place) for name, place in group])
            )
            name, detection = max(
                ((name, int(cameras[name].clusters.detection_index[place])) for name, place in group),
                key=lambda item: float(cameras[item[0]].detections.score[item[1]]),
            )
            usual_m[number], spread[number] = cameras[name].sizes_m[detection], cameras[name].spreads[detection]
        points = Clusters.of(rows_of)
        return Objects(points.row, points.start, usual_m, spread, groups)


def fit_boxes(
    objects: Objects, cameras: Mapping[str, CameraClusters], scene: Scene, config: LidarConfig
) -> dict[str, Boxes3D]:
    """A box for each object, given to each camera that shows it, in order of that camera's detections. Rows of the
    objects count in the scene's clear points."""
    parts: dict[str, list[Boxes3D]] = {name: [] for name in cameras}
    if len(objects):
        _fit(objects, cameras, scene, config, parts)
    boxes = {name: Boxes3D.concatenate(of_camera) for name, of_camera in parts.items()}
    return {name: found[np.argsort(found.detection_index, kind="stable")] for name, found in boxes.items()}


def _fit(
    objects: Objects,
    cameras: Mapping[str, CameraClusters],
    scene: Scene,
    config: LidarConfig,
    parts: dict[str, list[Boxes3D]],
) -> None:
    usual_m, start = objects.usual_m, objects.start
    rows = scene.clear[objects.row]
    xyz_m = scene.xyz_m[rows].astype(np.float64)
    xy_m = xyz_m[:, :2]
    yaw_rad = fit_yaws(xy_m, start, config)
    low_m, high_m = extents_along(xy_m, start, yaw_rad, outliers=_OUTLIERS)
    largest_m = usual_m * (1 + _LARGEST_SPREADS * objects.spread)
    bottom_m, top_m = _heights(xyz_m, start, usual_m, largest_m, scene.ground)
    options = _hypotheses(low_m, high_m, yaw_rad, bottom_m, top_m, usual_m, largest_m)
    first_camera = [cameras[group[0][0]] for group in objects.members]
    sensor_xy_m = np.array([camera.view.position_m[:2] for camera in first_camera])
    overlap, of_member = _overlaps(options, objects, cameras)
    merit = overlap + _shape_merit(low_m, high_m, yaw_rad, usual_m, sensor_xy_m)
    best = merit.argmax(axis=1)
    center_std_m, yaw_std_rad = _deviations(options, merit, low_m, high_m, objects)
    points = np.diff(start)
    offset_s = np.add.reduceat(scene.offset_s[rows], start[:-1]) / points
    for number, group in enumerate(objects.members):
        option = int(best[number])
        center_m, size_m = options.center_m[number, option], options.size_m[number, option]
        turned = _OPTIONS[option, 0] == _LENGTH_ACROSS
        seen_m = _seen(low_m[number], high_m[number], center_m, float(yaw_rad[number]), turned=bool(turned))
        for name, place in group:
            clusters = cameras[name].clusters
            detection = int(clusters.detection_index[place])
            own = of_member[name, place][option]
            score = points[number] / (points[number] + _POINTS_HALF_SURE) * (1 + own) / 2
            parts[name].append(
                Boxes3D(
                    center_m=center_m[None].astype(np.float32),
                    size_m=size_m[None].astype(np.float32),
                    yaw_rad=options.yaw_rad[number, option, None].astype(np.float32),
                    score=np.array([score], np.float32),
                    class_id=cameras[name].detections.class_id[[detection]],
                    num_points=np.array([points[number]], np.int32),
                    detection_index=np.array([detection], np.int32),
                    source=np.array([BoxSource.CLUSTER], np.int8),
                    center_std_m=center_std_m[[number]].astype(np.float32),
                    yaw_std_rad=yaw_std_rad[[number]].astype(np.float32),
                    seen_m=seen_m[None].astype(np.float32),
                    offset_s=np.array([offset_s[number]], np.float32),
                )
            )


def _overlaps(
    options: _Hypotheses, objects: Objects, cameras: Mapping[str, CameraClusters]
) -> tuple[NDArray[np.float64], dict[Member, NDArray[np.float64]]]:
    """(C, 18) the mean overlap of each hypothesis with the detections of the object, and (18,) by member."""
    of_member: dict[Member, NDArray[np.float64]] = {}
    for name, camera in cameras.items():
        mine = [
            (number, place) for number, group in enumerate(objects.members) for owner, place in group if owner == name
        ]
        if mine:
            numbers, places = np.array(mine).T
            detected_px = camera.detections.xyxy_px[camera.clusters.detection_index[places]]
            found = _overlap_in_image(options[numbers], detected_px, camera.view)
            of_member.update(((name, int(place)), found[row]) for row, place in enumerate(places))
    mean = np.stack([np.mean([of_member[member] for member in group], axis=0) for group in objects.members])
    return mean, of_member


def _deviations(
    options: _Hypotheses,
    merit: NDArray[np.float64],
    low_m: NDArray[np.float64],
    high_m: NDArray[np.float64],
    objects: Objects,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(C, 2) standard deviation of each centre along the best hypothesis and across it, and (C,) of its yaw.

    Hypotheses of nearly the same merit that lie apart make a box unsure; so does a side that was filled up to a usual
    size, by how far the sizes of its class differ. A yaw is the surer, the longer the seen side and the more points."""
    row, best = np.arange(len(objects)), merit.argmax(axis=1)
    chance = np.exp((merit - merit[row, best, None]) / _SOFTNESS)
    chance /= chance.sum(axis=1, keepdims=True)
    yaw_rad = options.yaw_rad[row, best]
    cos, sin = np.cos(yaw_rad)[:, None], np.sin(yaw_rad)[:, None]
    apart_m = options.center_m[..., :2] - options.center_m[row, best, None, :2]
    along_m, across_m = cos * apart_m[..., 0] + sin * apart_m[..., 1], cos * apart_m[..., 1] - sin * apart_m[..., 0]
    between_m2 = np.stack(
        [(chance * np.square(along_m)).sum(axis=1), (chance * np.square(across_m)).sum(axis=1)], axis=1
    )
    turned = _OPTIONS[best, 0] == _LENGTH_ACROSS
    seen_m = np.where(turned[:, None], (high_m - low_m)[:, ::-1], high_m - low_m)
    unseen = np.clip(1 - seen_m / objects.usual_m[:, :2], 0, 1)
    filled_m = objects.spread[:, :2] * objects.usual_m[:, :2] / 2 * np.minimum(2 * unseen, 1)
    noise_m = _POSITION_NOISE_M * (1 + 4 / np.sqrt(np.diff(objects.start)))
    center_std_m = np.sqrt(between_m2 + np.square(filled_m) + np.square(noise_m)[:, None])
    lengthwise: NDArray[np.float64] = np.asarray(chance * (_OPTIONS[:, 0] == _LENGTH_ALONG)).sum(axis=1)
    other_way = np.clip(np.where(turned, lengthwise, 1 - lengthwise), 0.0, 1.0)
    longest_m = np.maximum((high_m - low_m).max(axis=1), 0.2)
    fitted_rad = _LEAST_YAW_STD_RAD + _YAW_STD_M / (longest_m * np.sqrt(np.diff(objects.start)))
    return center_std_m, np.hypot(np.minimum(fitted_rad, np.pi / 4), np.sqrt(other_way) * np.pi / 2)


def _seen(
    low_m: NDArray[np.float64],
    high_m: NDArray[np.float64],
    center_m: NDArray[np.float64],
    yaw_rad: float,
    *,
    turned: bool,
) -> NDArray[np.float64]:
    """(4,) as :class:`Boxes3D` has it, from extents (2,) along and across a yaw: the box's, or a quarter turn less."""
    cos, sin = np.cos(yaw_rad), np.sin(yaw_rad)
    middle_m = np.array([cos * center_m[0] + sin * center_m[1], cos * center_m[1] - sin * center_m[0]])
    low_m, high_m = low_m - middle_m, high_m - middle_m
    if turned:  # the length lies along the fitted yaw's left, the width along its back
        low_m, high_m = np.array([low_m[1], -high_m[0]]), np.array([high_m[1], -low_m[0]])
    return np.concatenate([low_m, high_m])


@dataclass(frozen=True, eq=False)
class _Hypotheses:
    """(C, 18) boxes, one for each row of _OPTIONS: ``center_m`` and ``size_m`` (C, 18, 3), ``yaw_rad`` (C, 18)."""

    center_m: NDArray[np.float64]
    size_m: NDArray[np.float64]
    yaw_rad: NDArray[np.float64]

    def __getitem__(self, rows: NDArray[np.intp]) -> _Hypotheses:
        return _Hypotheses(self.center_m[rows], self.size_m[rows], self.yaw_rad[rows])


def _heights(
    xyz_m: NDArray[np.float64],
    start: NDArray[np.int64],
    usual_m: NDArray[np.float64],
    largest_m: NDArray[np.float64],
    ground: Ground,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(C,) lowest and (C,) highest z of each object: from the ground to the points, and at least nearly as tall as
    usual, because LiDAR often misses a roof."""
    first = start[:-1]
    ground_m = ground.at(np.add.reduceat(xyz_m[:, :2], first) / np.diff(start)[:, None]).astype(np.float64)
    bottom_m = np.fmin(ground_m, np.minimum.reduceat(xyz_m[:, 2], first))
    seen_m = np.maximum.reduceat(xyz_m[:, 2], first) - bottom_m
    return bottom_m, bottom_m + np.clip(seen_m, _LOWEST_HEIGHT * usual_m[:, 2], largest_m[:, 2])


def _hypotheses(
    low_m: NDArray[np.float64],
    high_m: NDArray[np.float64],
    yaw_rad: NDArray[np.float64],
    bottom_m: NDArray[np.float64],
    top_m: NDArray[np.float64],
    usual_m: NDArray[np.float64],
    largest_m: NDArray[np.float64],
) -> _Hypotheses:
    """Every option for each cluster: the points' extent, filled up to the usual size on the side that is not kept, and
    cut there to the largest."""
    usual_sides_m = np.stack([usual_m[:, :2], usual_m[:, 1::-1]], axis=1)[:, _OPTIONS[:, 0]]
    largest_sides_m = np.stack([largest_m[:, :2], largest_m[:, 1::-1]], axis=1)[:, _OPTIONS[:, 0]]
    side_m = np.clip((high_m - low_m)[:, None], usual_sides_m, largest_sides_m)
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
    corners_camera_m = transform_points(view.camera_SE3_ego, corners_m.reshape(-1, 3))
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
        [cos * sensor_xy_m[:, 0] + sin * sensor_xy_m[:, 1], cos * sensor_xy_m[:, 1] - sin * sensor_xy_m[:, 0]], axis=1
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
