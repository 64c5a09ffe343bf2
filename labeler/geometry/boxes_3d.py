"""Upright boxes in 3D: centre, size as length, width, height, and yaw about z (0 = length along x), in metres and
radians.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

_CORNER_SIGNS = np.array([[x, y, z] for x in (1, -1) for y in (1, -1) for z in (1, -1)]) / 2


def corners_of(
    center_m: NDArray[np.floating], size_m: NDArray[np.floating], yaw_rad: NDArray[np.floating]
) -> NDArray[np.float64]:
    """(N, 8, 3) corners of N boxes from (N, 3) centres, (N, 3) sizes and (N,) yaws."""
    local = _CORNER_SIGNS[None] * np.asarray(size_m, dtype=np.float64)[:, None, :]
    cos, sin = np.cos(yaw_rad)[:, None], np.sin(yaw_rad)[:, None]
    turned = np.stack(
        [cos * local[..., 0] - sin * local[..., 1], sin * local[..., 0] + cos * local[..., 1], local[..., 2]], axis=-1
    )
    return turned + np.asarray(center_m, dtype=np.float64)[:, None, :]


def bev_intersection(
    center_a_m: NDArray[np.floating], size_a_m: NDArray[np.floating], yaw_a_rad: float,
    center_b_m: NDArray[np.floating], size_b_m: NDArray[np.floating], yaw_b_rad: float,
) -> float:  # fmt: skip
    """Area in square metres that two boxes share when seen from above. Centres and sizes are (3,).

    OpenCV counts in float32, whose steps are 3 cm at city coordinates of 400 km. So a's centre becomes the origin."""
    offset_m = np.asarray(center_b_m, dtype=np.float64) - np.asarray(center_a_m, dtype=np.float64)
    kind, points = cv2.rotatedRectangleIntersection(
        _rectangle(np.zeros(2), size_a_m, yaw_a_rad), _rectangle(offset_m, size_b_m, yaw_b_rad)
    )
    if kind == cv2.INTERSECT_NONE:
        return 0.0
    return float(cv2.contourArea(cv2.convexHull(points)))


def iou_3d(
    center_a_m: NDArray[np.floating], size_a_m: NDArray[np.floating], yaw_a_rad: float,
    center_b_m: NDArray[np.floating], size_b_m: NDArray[np.floating], yaw_b_rad: float,
) -> tuple[float, float]:  # fmt: skip
    """(volume IoU, bird's-eye IoU) of two upright boxes. Centres and sizes are (3,)."""
    shared_m2 = bev_intersection(center_a_m, size_a_m, yaw_a_rad, center_b_m, size_b_m, yaw_b_rad)
    area_a, area_b = float(size_a_m[0] * size_a_m[1]), float(size_b_m[0] * size_b_m[1])
    top = min(center_a_m[2] + size_a_m[2] / 2, center_b_m[2] + size_b_m[2] / 2)
    bottom = max(center_a_m[2] - size_a_m[2] / 2, center_b_m[2] - size_b_m[2] / 2)
    shared_m3 = shared_m2 * max(0.0, float(top - bottom))
    union_m2 = area_a + area_b - shared_m2
    union_m3 = area_a * float(size_a_m[2]) + area_b * float(size_b_m[2]) - shared_m3
    return (shared_m3 / union_m3 if union_m3 > 0 else 0.0, shared_m2 / union_m2 if union_m2 > 0 else 0.0)


def bev_iou_limit(
    center_m: NDArray[np.floating], size_m: NDArray[np.floating], yaw_rad: NDArray[np.floating]
) -> NDArray[np.float64]:
    """(N, N) what the bird's-eye IoU of each two of N boxes is at most: cheap, to leave out pairs that are apart.

    Both lie between their outermost points along the line through their centres and across it, so they share at most
    the rectangle where these spans meet."""
    half_m = size_m[:, :2].astype(np.float64) / 2
    apart_m = center_m[None, :, :2].astype(np.float64) - center_m[:, None, :2]
    distance_m = np.hypot(apart_m[..., 0], apart_m[..., 1])
    turned_rad = np.arctan2(apart_m[..., 1], apart_m[..., 0]) - yaw_rad[:, None]
    cos, sin = np.abs(np.cos(turned_rad)), np.abs(np.sin(turned_rad))
    along_m = half_m[:, :1] * cos + half_m[:, 1:] * sin
    across_m = half_m[:, :1] * sin + half_m[:, 1:] * cos
    meet_m = np.minimum(along_m + along_m.T - distance_m, 2 * np.minimum(along_m, along_m.T)).clip(min=0)
    area_m2 = 4 * half_m.prod(axis=1)
    shared_m2 = np.minimum(meet_m * 2 * np.minimum(across_m, across_m.T), np.minimum(area_m2[:, None], area_m2))
    return shared_m2 / np.maximum(area_m2[:, None] + area_m2 - shared_m2, 1e-9)


def _rectangle(
    center_m: NDArray[np.floating], size_m: NDArray[np.floating], yaw_rad: float
) -> tuple[tuple[float, float], tuple[float, float], float]:
    return (float(center_m[0]), float(center_m[1])), (float(size_m[0]), float(size_m[1])), float(np.degrees(yaw_rad))
