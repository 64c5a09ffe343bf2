"""Drives and boxes as plain arrays to draw: which points, which lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.scene.types import SceneBox
from labeler.drive.types import Sweep
from labeler.geometry.boxes_3d import corners_of

MAX_POINTS = 120_000

# Corners of labeler.geometry.boxes_3d.corners_of count in binary: 4 = rear, 2 = right, 1 = bottom. An edge joins two
# corners that differ in one bit.
_EDGES = np.array([(a, a | bit) for bit in (4, 2, 1) for a in range(8) if not a & bit])
LINES_PER_BOX = len(_EDGES) + 1  # and the heading
_FRONT_TOP, _ALL_TOP = (0, 2), (0, 2, 4, 6)

_CUBE_FACES = np.array(
    [(0, 3, 1), (0, 2, 3), (4, 7, 6), (4, 5, 7), (0, 5, 4), (0, 1, 5), (2, 7, 3), (2, 6, 7), (0, 6, 2), (0, 4, 6),
     (1, 7, 5), (1, 3, 7)],
    dtype=np.uint32,
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class PointCloud:
    """Points to draw: ``xyz_m`` (N, 3) float32 in the ego frame and ``reflectance`` (N,) float32 in 0..1."""

    xyz_m: NDArray[np.float32]
    reflectance: NDArray[np.float32]


def point_cloud(sweep: Sweep | None, *, max_points: int = MAX_POINTS) -> PointCloud:
    """The points of a sweep that are finite, thinned evenly to ``max_points``; none without a sweep.

    Sensors count intensity in units of their own; the 98th percentile of the sweep becomes 1."""
    if sweep is None:
        return PointCloud(np.zeros((0, 3), np.float32), np.zeros(0, np.float32))
    kept = np.flatnonzero(np.isfinite(sweep.xyz_m).all(axis=1))
    if len(kept) > max_points:
        kept = kept[np.linspace(0, len(kept) - 1, max_points).astype(np.int64)]
    intensity = np.nan_to_num(sweep.intensity[kept], nan=0.0, posinf=0.0, neginf=0.0)
    bright = float(np.percentile(intensity, 98)) if len(kept) else 0.0
    reflectance = np.clip(intensity / bright, 0.0, 1.0) if bright > 0 else np.zeros(len(kept))
    return PointCloud(sweep.xyz_m[kept].astype(np.float32), reflectance.astype(np.float32))


def ground_height_m(xyz_m: NDArray[np.float32]) -> float:
    """Height of the road near the car in the ego frame: where most points lie within 25 m. 0 without points."""
    near = xyz_m[np.hypot(xyz_m[:, 0], xyz_m[:, 1]) < 25.0, 2]
    near = near[(near > -4.0) & (near < 2.0)]
    if not len(near):
        return 0.0
    counts, edges = np.histogram(near, bins=60, range=(-4.0, 2.0))
    fullest = int(np.argmax(counts))
    return float(edges[fullest] + edges[fullest + 1]) / 2


def box_corners(boxes: Sequence[SceneBox]) -> NDArray[np.float64]:
    """(N, 8, 3) corners in the ego frame."""
    center_m = np.array([box.center_m for box in boxes], dtype=np.float64).reshape(-1, 3)
    size_m = np.array([box.size_m for box in boxes], dtype=np.float64).reshape(-1, 3)
    yaw_rad = np.array([box.yaw_rad for box in boxes], dtype=np.float64)
    return corners_of(center_m, size_m, yaw_rad)


def box_lines(corners: NDArray[np.float64]) -> NDArray[np.float32]:
    """(N * 13, 2, 3) lines of N boxes: twelve edges each, and one on the roof from its middle to the front."""
    edges = corners[:, _EDGES]
    roof = corners[:, _ALL_TOP].mean(axis=1)
    front = corners[:, _FRONT_TOP].mean(axis=1)
    heading = np.stack([roof, front], axis=1)[:, None]
    return np.concatenate([edges, heading], axis=1).reshape(-1, 2, 3).astype(np.float32)


def unit_cube() -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """(8, 3) vertices and (12, 3) faces of a cube with edges of one metre about the origin, faces turned outward."""
    corners = corners_of(np.zeros((1, 3)), np.ones((1, 3)), np.zeros(1))[0]
    return corners.astype(np.float32), _CUBE_FACES
