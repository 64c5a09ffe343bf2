"""Clusters grow over what their camera does not see of an object, so that two cameras come to the same points.

An object that the image's border cuts has a detection of its visible part, and a cluster of that part's points. The
rest of it is in the sweep too: unpainted points beyond that border that hang together with the cluster. Those are taken
in, unless they belong to another object: one that this camera detected too, or one that another camera sees whole.

Clusters of two cameras that then share most of their points are of one object, and are given the points of both.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from labeler.detection.types import Detections
from labeler.lidar.clustering import Clusters, connected_parts
from labeler.lidar.config import LidarConfig
from labeler.lidar.painting.view import View

_REACH = 1.2
_SHARED = 0.5

Member = tuple[str, int]
"""A camera, and the number of one of its clusters."""


@dataclass(frozen=True, eq=False)
class CameraClusters:
    """One camera's clusters, with what they were made from: ``sizes_m`` (N, 3) are the usual sizes of its N
    detections, ``spreads`` (N, 3) how far they differ."""

    view: View
    detections: Detections
    sizes_m: NDArray[np.float64]
    spreads: NDArray[np.float64]
    clusters: Clusters

    def cut_sides(self) -> NDArray[np.bool_]:
        """(C, 4) which sides of the image cut the detection of each cluster."""
        return self.view.sides_cutting(self.detections.xyxy_px[self.clusters.detection_index])


def grow_clusters(
    cameras: Mapping[str, CameraClusters], xyz_m: NDArray[np.float32], config: LidarConfig
) -> dict[str, CameraClusters]:
    """The clusters of all cameras, those at an image's border grown. Rows of clusters count in (N, 3) ``xyz_m``, which
    must be clear of the ground.
    """
    whole = {name: _rows_of_whole(camera, len(xyz_m)) for name, camera in cameras.items()}
    candidates: list[_Candidates] = []
    xy_m = np.ascontiguousarray(xyz_m[:, 0]), np.ascontiguousarray(xyz_m[:, 1])
    for name, camera in cameras.items():
        taken = np.zeros(len(xyz_m), np.bool_)
        for other, rows in whole.items():
            if other != name:
                taken |= rows
        taken[camera.clusters.row] = True
        candidates.extend(_candidates(name, camera, xyz_m, xy_m, taken))
    if not candidates:
        return dict(cameras)
    rows = np.concatenate([candidate.rows for candidate in candidates])
    counts = [len(candidate.rows) for candidate in candidates]
    part = connected_parts(xyz_m[rows], np.repeat(np.arange(len(counts), dtype=np.int32), counts), config)
    grown: dict[Member, NDArray[np.int32]] = {}
    for candidate, of_rows in zip(candidates, np.split(part, np.cumsum(counts)[:-1]), strict=True):
        joined = np.isin(of_rows, of_rows[: candidate.seeds])
        grown[candidate.member] = candidate.rows[joined]
    return {name: replace(camera, clusters=_with(camera.clusters, name, grown)) for name, camera in cameras.items()}


def _with(clusters: Clusters, camera: str, grown: Mapping[Member, NDArray[np.int32]]) -> Clusters:
    return Clusters.of(
        {
            int(detection): grown.get((camera, number), clusters.rows_of(number))
            for number, detection in enumerate(clusters.detection_index)
        }
    )


def link_clusters(cameras: Mapping[str, CameraClusters], points: int) -> list[list[Member]]:
    """The clusters of all cameras in groups of one object: those of different cameras that share at least half of the
    points of the smaller, the most shared first. A group has at most one cluster of each camera. Rows of clusters are
    below ``points``."""
    group_of = {
        (name, number): [(name, number)] for name, camera in cameras.items() for number in range(len(camera.clusters))
    }
    number_at = {name: _number_of_points(camera.clusters, points) for name, camera in cameras.items()}
    pairs: list[tuple[float, Member, Member]] = []
    for a, b in combinations(cameras, 2):
        both = np.flatnonzero((number_at[a] >= 0) & (number_at[b] >= 0))
        found, counts = np.unique(np.stack([number_at[a][both], number_at[b][both]]), axis=1, return_counts=True)
        for first, second, count in zip(*found.tolist(), counts.tolist(), strict=True):
            smaller = min(cameras[a].clusters.num_points[first], cameras[b].clusters.num_points[second])
            if count >= _SHARED * smaller:
                pairs.append((count / smaller, (a, first), (b, second)))
    for _, a, b in sorted(pairs, key=lambda pair: (-pair[0], pair[1], pair[2])):
        first, second = group_of[a], group_of[b]
        if not {name for name, _ in first} & {name for name, _ in second}:
            first.extend(second)
            group_of.update((member, first) for member in second)
    return list({id(group): group for group in group_of.values()}.values())


def _number_of_points(clusters: Clusters, points: int) -> NDArray[np.int32]:
    """(points,) the number of the cluster that each point belongs to, -1 for none."""
    number = np.full(points, -1, np.int32)
    number[clusters.row] = np.repeat(np.arange(len(clusters), dtype=np.int32), clusters.num_points)
    return number


def _rows_of_whole(camera: CameraClusters, count: int) -> NDArray[np.bool_]:
    """(count,) which points belong to an object that this camera sees whole."""
    rows = np.zeros(count, np.bool_)
    for number in np.flatnonzero(~camera.cut_sides().any(axis=1)):
        rows[camera.clusters.rows_of(int(number))] = True
    return rows


@dataclass(frozen=True, eq=False)
class _Candidates:
    """The points of one cluster at the border, the first ``seeds`` of ``rows``, and free points beyond the border."""

    member: Member
    seeds: int
    rows: NDArray[np.int32]


def _candidates(
    name: str, camera: CameraClusters, xyz_m: NDArray[np.float32],
    xy_m: tuple[NDArray[np.float32], NDArray[np.float32]], taken: NDArray[np.bool_],
) -> list[_Candidates]:  # fmt: skip
    """Those of each cluster that the border cuts: free points within the reach of an object of its class. ``xy_m`` are
    the first columns of ``xyz_m``, each for itself."""
    clusters = camera.clusters
    cut_sides = camera.cut_sides()
    x_m, y_m = xy_m
    found: list[_Candidates] = []
    for number in np.flatnonzero(cut_sides.any(axis=1)).tolist():
        seed = clusters.rows_of(number)
        reach_m = np.float32(_REACH * float(camera.sizes_m[int(clusters.detection_index[number]), :2].max()))
        low, high = xyz_m[seed, :2].min(axis=0) - reach_m, xyz_m[seed, :2].max(axis=0) + reach_m
        near = np.flatnonzero((x_m >= low[0]) & (x_m <= high[0]) & (y_m >= low[1]) & (y_m <= high[1]))
        near = near[~taken[near]]
        near = near[camera.view.beyond(xyz_m[near], cut_sides[number])]
        found.append(_Candidates((name, number), len(seed), np.concatenate([seed, near.astype(np.int32)])))
    return found
