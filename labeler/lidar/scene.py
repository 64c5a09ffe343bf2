"""A sweep made ready for the LiDAR step, once for all cameras: at the frame's time, its ground known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.drive.types import Sweep
from labeler.geometry.se3 import transform_points
from labeler.lidar.config import LidarConfig
from labeler.lidar.ground import Ground, above_ground, estimate_ground


@dataclass(frozen=True, eq=False)
class Scene:
    """``xyz_m`` (N, 3) float32 finite points in the ego frame at the frame's time, ``intensity`` (N,) float32 as
    recorded, ``offset_s`` (N,) float32 when each was measured, less the frame's time. ``ground`` is the ground under
    them, ``clear`` (K,) intp the rows that stand clear of it and near enough to be boxed.
    """

    xyz_m: NDArray[np.float32]
    intensity: NDArray[np.float32]
    offset_s: NDArray[np.float32]
    ground: Ground
    clear: NDArray[np.intp]


def prepare_scene(
    sweep: Sweep,
    config: LidarConfig,
    *,
    frame_time_ns: int | None = None,
    frame_ego_SE3_sweep_ego: NDArray[np.float64] | None = None,
) -> Scene:
    """``frame_time_ns`` is the frame's time, the sweep's when None. ``frame_ego_SE3_sweep_ego`` (4, 4) maps the ego
    frame at the sweep's time to that at the frame's, identity when None: a frame may borrow a sweep of another time.
    """
    xyz_m = sweep.xyz_m
    with np.errstate(invalid="ignore"):
        finite = np.isfinite(xyz_m[:, 0] + xyz_m[:, 1] + xyz_m[:, 2])
    intensity, offset_ns = sweep.intensity, sweep.offset_ns
    if not finite.all():
        xyz_m, intensity = xyz_m[finite], intensity[finite]
        offset_ns = None if offset_ns is None else offset_ns[finite]
    if frame_ego_SE3_sweep_ego is not None:
        xyz_m = transform_points(frame_ego_SE3_sweep_ego, xyz_m).astype(np.float32)
    borrowed_ns = 0 if frame_time_ns is None else sweep.timestamp_ns - frame_time_ns
    offset_s = np.full(len(xyz_m), borrowed_ns * 1e-9, np.float32)
    if offset_ns is not None:
        offset_s += offset_ns.astype(np.float32) * np.float32(1e-9)
    ground = estimate_ground(xyz_m, config)
    near = (np.abs(xyz_m[:, 0]) <= config.max_distance_m) & (np.abs(xyz_m[:, 1]) <= config.max_distance_m)
    clear = np.flatnonzero(near & above_ground(xyz_m, ground, config))
    return Scene(xyz_m, intensity, offset_s, ground, clear)
