"""Matrices that lead from the world to a camera's or the sun's image, and what lies in front of them."""

import numpy as np
from numpy.typing import NDArray

NEAR_M, FAR_M = 0.3, 1200.0
"""Nothing nearer or farther along a camera's axis is drawn."""
_SUN_DEPTH_M = 260.0


def camera_projection(intrinsics: NDArray[np.float64], width_px: int, height_px: int) -> NDArray[np.float64]:
    """(4, 4) from a camera's frame (x right, y down, z forward) to OpenGL's clip space, so that the pinhole's pixel
    (0, 0) is the image's upper left corner."""
    fx, fy, cx, cy = intrinsics[0, 0], intrinsics[1, 1], intrinsics[0, 2], intrinsics[1, 2]
    deep = FAR_M - NEAR_M
    return np.array([
        [2 * fx / width_px, 0, 2 * cx / width_px - 1, 0],
        [0, -2 * fy / height_px, 1 - 2 * cy / height_px, 0],
        [0, 0, (FAR_M + NEAR_M) / deep, -2 * FAR_M * NEAR_M / deep],
        [0, 0, 1, 0],
    ])  # fmt: skip


def depth_of(window_depth: NDArray[np.float32]) -> NDArray[np.float32]:
    """Metres along the camera's axis from the depth buffer's values, infinite where nothing was drawn."""
    clip = 2 * window_depth.astype(np.float64) - 1
    depth_m = 2 * NEAR_M * FAR_M / (FAR_M + NEAR_M - clip * (FAR_M - NEAR_M))
    return np.where(window_depth >= 1.0, np.inf, depth_m).astype(np.float32)


def frustum_planes(view_projection: NDArray[np.float64]) -> NDArray[np.float64]:
    """(5, 4) planes left, right, bottom, top and near: a point is inside where all of them are positive."""
    x, y, z, w = view_projection
    planes = np.stack([w + x, w - x, w + y, w - y, w + z])
    return planes / np.linalg.norm(planes[:, :3], axis=1, keepdims=True)


def in_frustum(
    planes: NDArray[np.float64], center_m: NDArray[np.float64], radius_m: NDArray[np.float64] | float
) -> NDArray[np.bool_]:
    """(N,) which balls around (N, 3) centres reach into a frustum."""
    distance_m = center_m @ planes[:, :3].T + planes[:, 3]
    return np.all(distance_m > -np.asarray(radius_m).reshape(-1, 1), axis=1)


def sun_projection(
    direction: NDArray[np.float64], middle_m: NDArray[np.float64], reach_m: float, size_px: int
) -> NDArray[np.float64]:
    """(4, 4) from the world to the clip space of a depth map that the sun sees: ``reach_m`` to each side of a middle,
    moved by whole pixels only, so that shadows don't swim."""
    right = np.cross([0.0, 0.0, 1.0], direction)
    right /= np.linalg.norm(right)
    view = np.eye(4)
    view[:3, :3] = np.stack([right, np.cross(direction, right), direction])
    offset = view[:3, :3] @ middle_m
    pixel_m = 2 * reach_m / size_px
    offset[:2] = np.round(offset[:2] / pixel_m) * pixel_m
    view[:3, 3] = -offset
    return np.diag([1 / reach_m, 1 / reach_m, -1 / _SUN_DEPTH_M, 1.0]) @ view


def in_sun_map(
    sun: NDArray[np.float64], center_m: NDArray[np.float64], radius_m: NDArray[np.float64] | float, reach_m: float
) -> NDArray[np.bool_]:
    """(N,) which balls touch the square that a sun's depth map covers."""
    place = center_m @ sun[:2, :3].T + sun[:2, 3]
    return np.all(np.abs(place) < 1 + np.asarray(radius_m).reshape(-1, 1) / reach_m, axis=1)
