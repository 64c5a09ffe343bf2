"""Where each detection stands, and how surely: from its 3D box, from a few LiDAR points, or from its height alone.

A detection that has a 3D box stands where that one's centre is. Where too few points for a box lie inside of a
detection, their depth still says more than the image does: the middle of the object lies a little behind them. Without
points, an object of usual height that looks so tall stands about so far away; classes differ in how far their members'
heights do. All of this is certain across the line of sight and less so along it, and the covariance says how much.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from labeler.detection.types import Detections
from labeler.lidar.config import LidarConfig, size_spreads, usual_sizes_m
from labeler.lidar.makers import CameraInput
from labeler.lidar.painting.by_boxes import paint_points
from labeler.lidar.painting.scores import PixelScores
from labeler.lidar.painting.view import BOTTOM, LEFT, RIGHT, TOP, View
from labeler.lidar.scene import Scene
from labeler.lidar.types import Boxes3D, Positions3D, PositionSource

_PIXEL_STD = 2.0
"""How far, in pixels, a detection's edge is off."""
_CUT_HEIGHT_SPREAD = 0.5
_CUT_SHORTER = 0.75
"""An object whose upper or lower end is out of the image is nearer than it looks, nobody knows by how much."""
_CUT_ACROSS = 0.5
_ACROSS = 0.15
_FITS = 2.5
"""Points whose depth is off from that of the height by more spreads than this are not of the object."""
_STRANGERS = 0.3
"""Few points may be of something else at about the same distance: so much of the height's uncertainty stays."""
_NEAR_BOX_M = 0.3


def find_positions(
    boxes: Boxes3D,
    camera: CameraInput,
    scene: Scene | None,
    config: LidarConfig,
    *,
    class_names: Sequence[str],
) -> Positions3D:
    """The position of every detection of one camera, in order; none for one whose corners are no box.

    ``boxes`` are the camera's 3D boxes; ``scene`` is None in a frame without a sweep."""
    detections, view, scores = camera.detections, camera.view, camera.scores
    if not len(detections):
        return Positions3D.empty()
    boxes = boxes[boxes.detection_index >= 0]
    size_m = usual_sizes_m(detections.class_id, tuple(class_names))
    spread = size_spreads(detections.class_id, tuple(class_names))[:, 2]
    depth_m, along_m, across_m = _from_height(detections, view, size_m, spread)
    source = np.full(len(detections), PositionSource.HEIGHT, np.int8)
    offset_s = np.zeros(len(detections), np.float32)
    boxed = np.zeros(len(detections), np.bool_)
    boxed[boxes.detection_index] = True
    if scene is not None and not boxed.all():
        _from_points(
            depth_m, along_m, source, offset_s, boxes=boxes,
            detections=detections, wanted=~boxed, view=view, scene=scene, config=config, size_m=size_m,
            class_names=tuple(class_names), scores=scores,
        )  # fmt: skip
    position_m, covariance = _placed(detections, view, depth_m, along_m, across_m, size_m)
    row = boxes.detection_index
    position_m[row], covariance[row] = boxes.center_m, _box_covariances(boxes)
    source[row], offset_s[row] = PositionSource.BOX, boxes.offset_s
    usable = np.isfinite(np.concatenate([position_m, covariance], axis=1)).all(axis=1)
    usable &= (detections.xyxy_px[:, 2:] > detections.xyxy_px[:, :2]).all(axis=1)
    found = Positions3D(
        detection_index=np.arange(len(detections), dtype=np.int32),
        position_m=position_m.astype(np.float32),
        position_cov_m2=covariance.astype(np.float32),
        position_source=source,
        position_offset_s=offset_s,
    )
    return found[np.flatnonzero(usable)]


def _from_height(
    detections: Detections, view: View, size_m: NDArray[np.float64], spread: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """(N,) depth of the near side, and (N,) standard deviations along and across the line of sight, in metres."""
    xyxy_px = detections.xyxy_px.astype(np.float64)
    tall_px = np.maximum(xyxy_px[:, 3] - xyxy_px[:, 1], 1.0)
    wide_px = np.maximum(xyxy_px[:, 2] - xyxy_px[:, 0], 1.0)
    cut = view.sides_cutting(xyxy_px)
    cut_height, cut_width = cut[:, TOP] | cut[:, BOTTOM], cut[:, LEFT] | cut[:, RIGHT]
    depth_m = view.intrinsics[1, 1] * size_m[:, 2] / tall_px * np.where(cut_height, _CUT_SHORTER, 1.0)
    relative = np.hypot(np.where(cut_height, _CUT_HEIGHT_SPREAD, spread), _PIXEL_STD / tall_px)
    across_px = np.where(cut_width, _CUT_ACROSS, _ACROSS) * wide_px + _PIXEL_STD
    return depth_m, depth_m * relative, depth_m * across_px / view.intrinsics[0, 0]


def _from_points(
    depth_m: NDArray[np.float64],
    along_m: NDArray[np.float64],
    source: NDArray[np.int8],
    offset_s: NDArray[np.float32],
    *,
    boxes: Boxes3D,
    detections: Detections,
    wanted: NDArray[np.bool_],
    view: View,
    scene: Scene,
    config: LidarConfig,
    size_m: NDArray[np.float64],
    class_names: tuple[str, ...],
    scores: PixelScores | None,
) -> None:
    """Put in the depth of those detections that are ``wanted`` (N,) and hold points at about the depth of their height
    that lie in no box of another one.

    The median by paint of these points is taken: a detection's middle shows the object, its corners what is behind.
    """
    rows = np.flatnonzero(wanted)
    clear = scene.clear[~_in_any(boxes, scene.clear_xyz_m)]
    painted = paint_points(scene.xyz_m[clear], detections[rows], view, config, class_names=class_names, scores=scores)
    painted = painted[painted.score > 0]
    owner = rows[painted.detection_index]
    off = np.abs(painted.depth_m - depth_m[owner]) / along_m[owner]
    fitting = np.flatnonzero(off <= _FITS)
    for detection in np.unique(owner[fitting]).tolist():
        mine = fitting[owner[fitting] == detection]
        mine = mine[np.argsort(painted.depth_m[mine], kind="stable")]
        weight: NDArray[np.float64] = np.cumsum(painted.score[mine] * np.exp(-np.square(off[mine]) / 2), dtype=float)
        middle = int(np.searchsorted(weight, float(weight[-1]) / 2))
        depth_m[detection] = painted.depth_m[mine[middle]]
        inside_m = float(size_m[detection, :2].mean()) / 4
        spread_m = float(painted.depth_m[mine].std())
        along_m[detection] = np.linalg.norm([_STRANGERS * float(along_m[detection]), inside_m, spread_m])
        source[detection] = PositionSource.POINTS
        offset_s[detection] = scene.offset_s[clear[painted.row[mine]]].mean()


def _in_any(boxes: Boxes3D, xyz_m: NDArray[np.float32]) -> NDArray[np.bool_]:
    """(N,) which of (N, 3) points lie in one of the boxes, or close to it, seen from above."""
    inside = np.zeros(len(xyz_m), np.bool_)
    x_m, y_m = np.ascontiguousarray(xyz_m[:, 0]), np.ascontiguousarray(xyz_m[:, 1])
    for center_m, size_m, yaw_rad in zip(boxes.center_m, boxes.size_m, boxes.yaw_rad, strict=True):
        half_m = size_m[:2] / 2 + _NEAR_BOX_M
        reach_m = np.hypot(*half_m)
        near = np.flatnonzero((np.abs(x_m - center_m[0]) <= reach_m) & (np.abs(y_m - center_m[1]) <= reach_m))
        off_x, off_y = x_m[near] - center_m[0], y_m[near] - center_m[1]
        along_m = np.cos(yaw_rad) * off_x + np.sin(yaw_rad) * off_y
        across_m = np.cos(yaw_rad) * off_y - np.sin(yaw_rad) * off_x
        inside[near[(np.abs(along_m) <= half_m[0]) & (np.abs(across_m) <= half_m[1])]] = True
    return inside


def _placed(
    detections: Detections,
    view: View,
    depth_m: NDArray[np.float64],
    along_m: NDArray[np.float64],
    across_m: NDArray[np.float64],
    size_m: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(N, 3) middles of objects whose near side is so deep behind the middle of their detection, and (N, 3) covariance
    as xx, xy, yy. The middle lies a quarter of length plus width behind the near side, more or less, as seen from any
    direction."""
    xyxy_px = detections.xyxy_px.astype(np.float64)
    pixel = (xyxy_px[:, :2] + xyxy_px[:, 2:]) / 2
    homogeneous = np.concatenate([pixel, np.ones((len(pixel), 1))], axis=1)
    ray = homogeneous @ np.linalg.inv(view.intrinsics).T @ view.ego_SE3_camera[:3, :3].T
    flat = ray[:, :2] / np.maximum(np.linalg.norm(ray[:, :2], axis=1, keepdims=True), 1e-9)
    position_m = view.position_m + ray * depth_m[:, None]
    position_m[:, :2] += flat * size_m[:, :2].sum(axis=1, keepdims=True) / 4
    depth_std_m = np.hypot(along_m, np.abs(size_m[:, 0] - size_m[:, 1]) / 4)
    return position_m, _covariance(flat, depth_std_m, across_m)


def _box_covariances(boxes: Boxes3D) -> NDArray[np.float64]:
    """(N, 3) as xx, xy, yy."""
    yaw_rad = boxes.yaw_rad.astype(np.float64)
    forward = np.stack([np.cos(yaw_rad), np.sin(yaw_rad)], axis=1)
    along_m, across_m = boxes.center_std_m.astype(np.float64).T
    return _covariance(forward, along_m, across_m)


def _covariance(
    forward: NDArray[np.float64], along_m: NDArray[np.float64], across_m: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(N, 3) as xx, xy, yy, from standard deviations along (N, 2) unit vectors and across them."""
    x, y = forward.T
    along_m2, across_m2 = np.square(along_m), np.square(across_m)
    return np.stack(
        [
            along_m2 * x * x + across_m2 * y * y,
            (along_m2 - across_m2) * x * y,
            along_m2 * y * y + across_m2 * x * x,
        ],
        axis=1,
    )
