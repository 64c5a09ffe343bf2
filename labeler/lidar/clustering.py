"""Which of the painted points belong to each detection's object.

Inside of a box the LiDAR sees the object, and also what stands behind, beside and before it. Seen from above, the
painted points of each box fall into clusters (cells of a grid that touch). A cluster counts by its share of the box's
paint; by how much of it stays inside of the box (a wall, or a neighbour, reaches out of it) and how much of the box's
width it fills (a neighbour fills another part of it); and by how well its
distance agrees with the size of the box in the image: an object of usual height that looks so tall stands about so far
away. The nearest of the clusters that count is the object, because what is nearer hides
what is farther. Detections choose in order of how clear their case is, and a point that one has taken is not there for
the others.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from labeler.detection.types import Detections
from labeler.lidar.config import LidarConfig
from labeler.lidar.painting.by_boxes import PaintedPoints
from labeler.lidar.painting.view import View

_DEEPER_SPREAD = 0.35
_NEARER_SPREAD = 0.5
_LONGER = 1.4
_LEAST_WIDTH_FIT = 0.1


@dataclass(frozen=True, eq=False)
class Clusters:
    """Points split into objects: at most one cluster for each detection of a camera.

    ``row`` (P,) int32 are the rows of points that belong to an object, sorted by cluster; ``start`` (C + 1,) int64
    where each cluster begins; ``detection_index`` (C,) int32 increasing.
    """

    row: NDArray[np.int32]
    start: NDArray[np.int64]
    detection_index: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.detection_index)

    @property
    def num_points(self) -> NDArray[np.int64]:
        return np.diff(self.start)

    def rows_of(self, cluster: int) -> NDArray[np.int32]:
        """The rows of one cluster's points."""
        return self.row[self.start[cluster] : self.start[cluster + 1]]

    @staticmethod
    def of(rows_of: Mapping[int, NDArray[np.integer]]) -> Clusters:
        """From the rows of each detection's points."""
        parts = [rows.astype(np.int32) for _, rows in sorted(rows_of.items())]
        start = np.cumsum([0, *(len(part) for part in parts)], dtype=np.int64)
        return Clusters(np.concatenate([np.zeros(0, np.int32), *parts]), start, np.array(sorted(rows_of), np.int32))


def cluster_painted_points(
    painted: PaintedPoints,
    around: NDArray[np.int32],
    detections: Detections,
    sizes_m: NDArray[np.float64],
    view: View,
    config: LidarConfig,
) -> Clusters:
    """The cluster of each detection's object; detections without one get none.

    ``around`` (M,) is what :func:`components_of` says of the painted points, ``sizes_m`` (N, 3) are the usual sizes of
    the N detections. Ground points must have been removed from ``painted``."""
    contained = _share_inside(painted, around) * _width_fit(painted, around, detections, view)
    inside = painted.score > 0
    order = np.flatnonzero(inside)[np.argsort(around[inside], kind="stable")]
    painted, contained, component = painted[order], contained[order], around[order]
    if not len(painted):
        return _gather(painted, {}, config)
    start = np.flatnonzero(np.diff(component, prepend=-1))
    owner = painted.detection_index[start]
    merit = _merit(painted, start, owner, detections, sizes_m, view) * contained[start]
    depth_m = np.add.reduceat(painted.depth_m, start) / np.diff(start, append=len(painted))
    pieces = np.split(np.arange(len(painted)), start[1:])
    free = np.ones(int(painted.row.max()) + 1, np.bool_)
    chosen: dict[int, NDArray[np.intp]] = {}
    for detection in _clearest_first(owner, merit):
        for candidate in _candidates(np.flatnonzero(owner == detection), merit, depth_m, config):
            piece = pieces[candidate]
            left = piece[free[painted.row[piece]]]
            if len(left) >= config.min_points and 2 * len(left) > len(piece):
                left = _without_depth(painted, left, float(sizes_m[detection, :2].max()))
                chosen[detection] = left
                free[painted.row[left]] = False
                break
    return _gather(painted, chosen, config)


def _candidates(
    mine: NDArray[np.intp], merit: NDArray[np.float64], depth_m: NDArray[np.floating], config: LidarConfig
) -> list[int]:
    """A detection's components in the order of choice: those that count, nearest first, then the others by merit."""
    counts = merit[mine] >= config.dominance * merit[mine].max()
    nearest_first = mine[counts][np.argsort(depth_m[mine[counts]], kind="stable")]
    others = mine[~counts][np.argsort(-merit[mine[~counts]], kind="stable")]
    return [int(candidate) for candidate in (*nearest_first, *others)]


def components_of(painted: Sequence[PaintedPoints], config: LidarConfig) -> list[NDArray[np.int32]]:
    """For the painted points of each camera (M,) a number, from 0 in each camera, the same for points of one detection
    that hang together seen from above."""
    counts = np.array([len(part) for part in painted], np.intp)
    if not counts.sum():
        return [np.zeros(0, np.int32) for _ in painted]
    most = 1 + max(int(part.detection_index.max(initial=0)) for part in painted)
    owner = np.concatenate([part.detection_index + number * most for number, part in enumerate(painted)])
    found = connected_parts(np.concatenate([part.xyz_m for part in painted]), owner.astype(np.int32), config)
    of_cameras = np.split(found, np.cumsum(counts)[:-1])
    return [part - part.min() if len(part) else part for part in of_cameras]


def connected_parts(xyz_m: NDArray[np.float32], owner: NDArray[np.int32], config: LidarConfig) -> NDArray[np.int32]:
    """(M,) a number for each of M points, at least one, the same for points of one owner that hang together seen from
    above: whose cells of a grid touch. ``owner`` (M,) must be sorted; the farther its points, the wider its cells.
    """
    starts = np.flatnonzero(np.diff(owner, prepend=-1))
    counts = np.diff(starts, append=len(owner))
    distance_m = np.hypot(xyz_m[:, 0], xyz_m[:, 1])
    mean_distance_m = np.add.reduceat(distance_m, starts) / counts
    cell_m = np.repeat(config.cluster_gap_m + config.cluster_gap_per_m * mean_distance_m, counts)
    place = np.floor(xyz_m[:, :2] / cell_m[:, None]).astype(np.int64)
    place -= place.min(axis=0) - 1
    stride = int(place.max()) + 2
    key = (owner.astype(np.int64) * stride + place[:, 0]) * stride + place[:, 1]
    cells, cell_of_point = np.unique(key, return_inverse=True)
    ends: list[NDArray[np.int64]] = []
    for step in (1, stride - 1, stride, stride + 1):
        neighbour = np.minimum(np.searchsorted(cells, cells + step), len(cells) - 1)
        here = np.flatnonzero(cells[neighbour] == cells + step)
        ends.append(np.stack([here, neighbour[here]]).astype(np.int64))
    edges: NDArray[np.int64] = np.concatenate(ends, axis=1)
    ones = np.ones(edges.shape[1], np.int8)
    graph = coo_array((ones, (edges[0], edges[1])), shape=(len(cells), len(cells)))
    labels: NDArray[np.int32] = connected_components(graph, directed=False)[1]
    return labels[cell_of_point]


def _share_inside(painted: PaintedPoints, component: NDArray[np.int32]) -> NDArray[np.float64]:
    """(M,) for each painted point the share of its component that lies inside of the box, not in the margin."""
    if not len(component):
        return np.zeros(0)
    inside = np.bincount(component, weights=painted.score > 0)
    return (inside / np.maximum(np.bincount(component), 1))[component]


def _width_fit(
    painted: PaintedPoints, component: NDArray[np.int32], detections: Detections, view: View
) -> NDArray[np.float64]:
    """(M,) for each painted point how well the width of its component fits that of the box: the IoU of the two spans
    in the image, softened because a half hidden object fills only a part of its box. Its neighbour fills another."""
    if not len(component):
        return np.zeros(0)
    x = painted.pixel[:, 0].astype(np.float64)  # of the type of what is filled, or ufunc.at takes its slow way
    low, high = np.full(int(component.max()) + 1, np.inf), np.full(int(component.max()) + 1, -np.inf)
    np.minimum.at(low, component, x)
    np.maximum.at(high, component, x)
    boxes_px = detections.xyxy_px[painted.detection_index].astype(np.float64)
    left, right = np.clip(boxes_px[:, 0], 0, view.size_px[0]), np.clip(boxes_px[:, 2], 0, view.size_px[0])
    shared = np.clip(np.minimum(high[component], right) - np.maximum(low[component], left), 0, None)
    spanned = np.maximum(high[component], right) - np.minimum(low[component], left)
    return _LEAST_WIDTH_FIT + (1 - _LEAST_WIDTH_FIT) * shared / np.maximum(spanned, 1.0)


def _merit(
    painted: PaintedPoints,
    start: NDArray[np.intp],
    owner: NDArray[np.int32],
    detections: Detections,
    sizes_m: NDArray[np.float64],
    view: View,
) -> NDArray[np.float64]:
    """(C,) merit in 0..1 of each component: its share of its box's paint, times how well its distance fits.

    The side nearest to the camera looks tallest, so it is its distance that the box's height tells."""
    paint = np.add.reduceat(painted.score.astype(np.float64), start)
    whole = np.bincount(owner, weights=paint)[owner]
    nearest_m = np.minimum.reduceat(painted.depth_m.astype(np.float64), start)
    box_px = detections.xyxy_px[owner].astype(np.float64)
    tall_px = np.maximum(box_px[:, 3] - box_px[:, 1], 1)
    usual_depth_m = view.intrinsics[1, 1] * sizes_m[owner, 2] / tall_px
    off = np.log(nearest_m / usual_depth_m)
    cut = (box_px[:, 1] <= 1) | (box_px[:, 3] >= view.size_px[1] - 2)
    spread = np.where(off > 0, _DEEPER_SPREAD, np.where(cut, np.inf, _NEARER_SPREAD))
    return paint / whole * np.exp(-np.square(off / spread) / 2)


def _clearest_first(owner: NDArray[np.int32], merit: NDArray[np.float64]) -> list[int]:
    """The detections by the merit of their best component, best first."""
    best = np.zeros(int(owner.max()) + 1)
    np.maximum.at(best, owner, merit)
    present = np.unique(owner)
    return [int(detection) for detection in present[np.argsort(-best[present], kind="stable")]]


def _without_depth(painted: PaintedPoints, rows: NDArray[np.intp], longest_m: float) -> NDArray[np.intp]:
    """The rows without those so far behind the nearest ones that no object of that size reaches there."""
    depth_m = painted.depth_m[rows]
    nearest_m = np.partition(depth_m, len(rows) // 10)[len(rows) // 10]
    return rows[depth_m <= nearest_m + _LONGER * longest_m]


def _gather(painted: PaintedPoints, chosen: dict[int, NDArray[np.intp]], config: LidarConfig) -> Clusters:
    return Clusters.of(
        {detection: painted.row[rows] for detection, rows in chosen.items() if len(rows) >= config.min_points}
    )
