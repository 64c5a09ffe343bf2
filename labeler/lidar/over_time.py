"""One object's 3D boxes over time: it has one size, it drives where it points, and its near sides are where they were.

Each sweep shows some sides of a vehicle, never all of them. Over its track the longest and widest view tells how large
it is at least, and the path tells which way it points once it has moved. A box is then rebuilt with that size and that
yaw around what was seen of it: the side that the sensor sees stays where it is, and the rest reaches away from it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from labeler.lidar.types import Boxes3D, BoxSource

_SEEN_QUANTILE = 0.75
_LARGER = 1.2
"""More than this times larger than usual it is in a few views only, which then show something else as well."""
_SAME_WAY = np.pi / 4
_MOVED_M = 3.0
"""The centres of a standing car wander as the ego car passes it and other sides come into view."""
_CLEARLY = 3.0
_MOVING_MPS = 2.0
_PATH_YAW_STD_RAD = 0.04
_PATH_YAW_STD_MPS = 0.4
"""Beside that, so much over the speed: the slower, the less a path tells the yaw."""
_WINDOW_S = 1.0
_STEADIER = 0.7
_AGREEING_RAD = 0.1


def refine_track_boxes(
    boxes: Boxes3D,
    city_SE3_ego: NDArray[np.float64],
    timestamp_ns: NDArray[np.int64],
    *,
    velocity_mps: NDArray[np.float64] | None = None,
) -> Boxes3D:
    """The same rows with one size, a steady yaw, and centres that fit what was seen; their source is TRACK.

    ``boxes`` (N) are all of one object, from one camera or several, in any order, each in its own ego frame;
    ``city_SE3_ego`` (N, 4, 4) is the pose of that frame, ``timestamp_ns`` (N,) its time. ``velocity_mps`` (N, 2) is the
    object's velocity in the city frame where a smoothed path is known; it is made from the centres when None. A row
    whose velocity is not finite counts as standing. ValueError when the numbers of rows differ.
    """
    count = len(boxes)
    if city_SE3_ego.shape != (count, 4, 4) or timestamp_ns.shape != (count,):
        raise ValueError(
            f"{count} boxes need poses ({count}, 4, 4) and times ({count},), "
            f"got {city_SE3_ego.shape} and {timestamp_ns.shape}"
        )
    if count == 0:
        return boxes
    ego_yaw_rad = np.arctan2(city_SE3_ego[:, 1, 0], city_SE3_ego[:, 0, 0])
    center_m = np.einsum("nij,nj->ni", city_SE3_ego[:, :3, :3], boxes.center_m.astype(np.float64))
    center_m += city_SE3_ego[:, :3, 3]
    time_s = (timestamp_ns - timestamp_ns.min()) * 1e-9 + boxes.offset_s
    if velocity_mps is None:
        velocity_mps = _velocities(center_m[:, :2], time_s, boxes)
    yaw = _steady_yaws(boxes, ego_yaw_rad, velocity_mps, _has_moved(center_m[:, :2], time_s, boxes))
    rows = _turned(boxes, yaw.yaw_rad - ego_yaw_rad)
    size_m = _one_size(rows)
    return _rebuilt(rows, size_m, yaw)


@dataclass(frozen=True, eq=False)
class _Yaws:
    """``yaw_rad`` (N,) in the city frame, ``std_rad`` (N,)."""

    yaw_rad: NDArray[np.float64]
    std_rad: NDArray[np.float64]


def _velocities(xy_m: NDArray[np.float64], time_s: NDArray[np.float64], boxes: Boxes3D) -> NDArray[np.float64]:
    """(N, 2) velocity at each row: a line through the centres within a second, the surer ones weighing more."""
    weight = 1 / (0.05 + np.square(boxes.center_std_m.astype(np.float64)).sum(axis=1))
    velocity = np.full((len(xy_m), 2), np.nan)
    for row, now_s in enumerate(time_s):
        near = np.flatnonzero(np.abs(time_s - now_s) <= _WINDOW_S)
        share = weight[near] / weight[near].sum()
        middle_s, middle_m = share @ time_s[near], share @ xy_m[near]
        spread = share @ np.square(time_s[near] - middle_s)
        if spread > 1e-4:
            velocity[row] = (share * (time_s[near] - middle_s)) @ (xy_m[near] - middle_m) / spread
    return velocity


def _has_moved(xy_m: NDArray[np.float64], time_s: NDArray[np.float64], boxes: Boxes3D) -> bool:
    """Whether the object is elsewhere in the last third of the time than in the first, by more than its centres are
    unsure, and than they scatter meanwhile."""
    first, last = time_s <= np.quantile(time_s, 1 / 3), time_s >= np.quantile(time_s, 2 / 3)
    begin_m, end_m = np.median(xy_m[first], axis=0), np.median(xy_m[last], axis=0)
    unsure_m = float(np.median(boxes.center_std_m.max(axis=1)))
    way = (end_m - begin_m) / max(float(np.hypot(*(end_m - begin_m))), 1e-9)
    across_m = (xy_m - begin_m) @ np.array([-way[1], way[0]])
    scatter_m = float(np.median(np.abs(across_m - np.median(across_m))))
    return float(np.hypot(*(end_m - begin_m))) > max(_MOVED_M, _CLEARLY * unsure_m, _CLEARLY * scatter_m)


def _steady_yaws(
    boxes: Boxes3D, ego_yaw_rad: NDArray[np.float64], velocity_mps: NDArray[np.float64], moved: bool
) -> _Yaws:
    """Along the path where it moves. A standing object keeps the yaw of the nearest moving moment, or, if it never
    moved, the axis that most of its boxes agree on."""
    own_rad = boxes.yaw_rad + ego_yaw_rad
    speed_mps = np.hypot(velocity_mps[:, 0], velocity_mps[:, 1])
    moving = np.flatnonzero(np.nan_to_num(speed_mps) >= _MOVING_MPS) if moved else np.zeros(0, np.intp)
    weight = 1 / np.square(np.maximum(boxes.yaw_std_rad.astype(np.float64), 0.02))
    if not len(moving):
        axis_rad, std_rad = _common_axis(own_rad, weight)
        return _Yaws(np.full(len(boxes), axis_rad), np.full(len(boxes), std_rad))
    path_rad = np.arctan2(velocity_mps[moving, 1], velocity_mps[moving, 0])
    nearest = moving[np.abs(np.arange(len(boxes))[:, None] - moving[None, :]).argmin(axis=1)]
    yaw_rad = path_rad[np.searchsorted(moving, nearest)]
    lag = (own_rad - yaw_rad + np.pi / 2) % np.pi - np.pi / 2
    path_std_rad = _PATH_YAW_STD_RAD + _PATH_YAW_STD_MPS / speed_mps[nearest]
    path_weight = 1 / np.square(path_std_rad)
    trust = np.where(np.abs(lag) < _SAME_WAY / 2, weight / (weight + path_weight), 0.0)
    return _Yaws(yaw_rad + trust * lag, np.where(trust > 0, 1 / np.sqrt(weight + path_weight), path_std_rad))


def _common_axis(yaw_rad: NDArray[np.float64], weight: NDArray[np.float64]) -> tuple[float, float]:
    """The axis that most of (N,) yaws agree on, whichever way they point along it, and its standard deviation."""
    apart_rad = (yaw_rad[:, None] - yaw_rad[None, :] + np.pi / 2) % np.pi - np.pi / 2
    best = int((np.exp(-np.square(apart_rad / _AGREEING_RAD) / 2) @ weight).argmax())
    near = np.abs(apart_rad[:, best]) <= 2 * _AGREEING_RAD
    axis_rad = yaw_rad[best] + float(np.average(apart_rad[near, best], weights=weight[near]))
    return axis_rad, max(_PATH_YAW_STD_RAD / 2, float(1 / np.sqrt(weight[near].sum())))


def _turned(boxes: Boxes3D, yaw_rad: NDArray[np.float64]) -> Boxes3D:
    """The boxes with other yaws, their length still the side that lies that way, and what was seen of them measured
    along the new axes."""
    turn = yaw_rad - boxes.yaw_rad
    quarter = np.abs(np.sin(turn)) > np.sin(_SAME_WAY)
    size_m, std_m = boxes.size_m.copy(), boxes.center_std_m.copy()
    size_m[quarter, :2] = size_m[quarter, 1::-1]
    std_m[quarter] = std_m[quarter, ::-1]
    low, high = boxes.seen_m[:, :2].astype(np.float64), boxes.seen_m[:, 2:].astype(np.float64)
    quarters = np.rint(turn / (np.pi / 2)).astype(int) % 4
    for turns, (new_low, new_high) in enumerate(_quarter_turns(low, high)):
        mine = quarters == turns
        low[mine], high[mine] = new_low[mine], new_high[mine]
    return replace(
        boxes,
        yaw_rad=yaw_rad.astype(np.float32),
        size_m=size_m,
        center_std_m=std_m,
        seen_m=np.concatenate([low, high], axis=1).astype(np.float32),
    )


def _quarter_turns(
    low: NDArray[np.float64], high: NDArray[np.float64]
) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Extents (N, 2) along and across axes that are turned by 0 to 3 quarters to the left."""
    turned = [(low.copy(), high.copy())]
    for _ in range(3):
        low, high = turned[-1]
        turned.append((np.stack([low[:, 1], -high[:, 0]], axis=1), np.stack([high[:, 1], -low[:, 0]], axis=1)))
    return turned


def _one_size(boxes: Boxes3D) -> NDArray[np.float64]:
    """(3,) the usual size of the boxes, or somewhat more where that much of the object has often been seen at once."""
    weight = boxes.score.astype(np.float64) + 1e-3
    size_m = np.array([_weighted_median(boxes.size_m[:, axis], weight) for axis in range(3)])
    seen_m = boxes.seen_m[:, 2:] - boxes.seen_m[:, :2]
    known = np.isfinite(seen_m).all(axis=1)
    if known.any():
        often_m = np.quantile(seen_m[known], _SEEN_QUANTILE, axis=0)
        size_m[:2] = np.where(often_m <= _LARGER * size_m[:2], np.maximum(size_m[:2], often_m), size_m[:2])
    return size_m


def _weighted_median(value: NDArray[np.floating], weight: NDArray[np.float64]) -> float:
    order = np.argsort(value, kind="stable")
    reached = np.cumsum(weight[order])
    return float(value[order[int(np.searchsorted(reached, float(reached[-1]) / 2))]])


def _rebuilt(boxes: Boxes3D, size_m: NDArray[np.float64], yaw: _Yaws) -> Boxes3D:
    """The boxes with one size: the side nearest to the sensor stays, seen points are covered, the ground stays."""
    cos, sin = np.cos(boxes.yaw_rad.astype(np.float64)), np.sin(boxes.yaw_rad.astype(np.float64))
    x_m, y_m = boxes.center_m[:, 0].astype(np.float64), boxes.center_m[:, 1].astype(np.float64)
    sensor = np.stack([-(cos * x_m + sin * y_m), -(cos * y_m - sin * x_m)], axis=1)
    grown_m = size_m[:2] - boxes.size_m[:, :2]
    beside = np.abs(sensor) <= boxes.size_m[:, :2] / 2
    shift_m = np.where(beside, 0.0, -np.sign(sensor) * grown_m / 2)
    low, high = boxes.seen_m[:, :2].astype(np.float64), boxes.seen_m[:, 2:].astype(np.float64)
    known = np.isfinite(low) & np.isfinite(high)
    half_m = size_m[:2] / 2
    least, most = np.where(known, high - half_m, -np.inf), np.where(known, low + half_m, np.inf)
    fits = least <= most
    shift_m = np.where(fits, np.clip(shift_m, least, np.maximum(least, most)), shift_m)
    center_m = boxes.center_m.astype(np.float64)
    center_m[:, 0] += cos * shift_m[:, 0] - sin * shift_m[:, 1]
    center_m[:, 1] += sin * shift_m[:, 0] + cos * shift_m[:, 1]
    center_m[:, 2] += (size_m[2] - boxes.size_m[:, 2]) / 2
    seen_m = boxes.seen_m - np.concatenate([shift_m, shift_m], axis=1)
    return replace(
        boxes,
        center_m=center_m.astype(np.float32),
        size_m=np.tile(size_m.astype(np.float32), (len(boxes), 1)),
        center_std_m=(boxes.center_std_m * _STEADIER).astype(np.float32),
        yaw_std_rad=yaw.std_rad.astype(np.float32),
        seen_m=seen_m.astype(np.float32),
        source=np.full(len(boxes), BoxSource.TRACK, np.int8),
    )
