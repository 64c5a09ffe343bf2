"""A sweep made ready for the LiDAR step, once for all cameras: at the frame's time, its ground known."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from labeler.drive.types import Sweep
from labeler.geometry.se3 import transform_points
from labeler.lidar.config import LidarConfig
from labeler.lidar.ground import Ground, above_ground, estimate_ground

_STRONG_INTENSITY = 0.99


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

    @cached_property
    def clear_xyz_m(self) -> NDArray[np.float32]:
        """(K, 3) the clear points; columns lie together, as they are computed with."""
        return np.take(self.xyz_m.T, self.clear, axis=1).T

    @cached_property
    def clear_above_m(self) -> NDArray[np.float32]:
        """(K,) how high the clear points are above the ground, NaN where that is not known."""
        return self.clear_xyz_m[:, 2] - self.ground.at(self.clear_xyz_m[:, :2])

    @cached_property
    def relative_intensity(self) -> NDArray[np.float32]:
        """(N,) in 0..1: sensors count in units of their own, so as a share of a sweep's strongest returns. What is not
        finite is 0."""
        usable = np.nan_to_num(self.intensity, nan=0.0, posinf=0.0, neginf=0.0)
        strong = float(np.quantile(usable, _STRONG_INTENSITY)) if len(usable) else 0.0
        if strong <= 0:
            return np.zeros(len(usable), np.float32)
        return np.clip(usable / np.float32(strong), 0, 1).astype(np.float32)


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
