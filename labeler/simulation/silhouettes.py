"""Where solids appear in an image: the box around what a camera would see of one if nothing stood in front of it, and
which pixels it would cover.

The box is exact for a solid that reaches out of the image or behind the camera: its triangles are cut at the sides of
the camera's pyramid (Sutherland and Hodgman, Reentrant polygon clipping, 1974) before they are projected.
"""

import math

import numpy as np
from numpy.typing import NDArray

from labeler.geometry.se3 import invert_se3, transform_points
from labeler.simulation.rig import View
from labeler.simulation.solids import Solid

NEAREST_M = 0.1


def whole_box(
    view: View, ego_SE3_body: NDArray[np.float64], triangles_m: NDArray[np.floating]
) -> NDArray[np.float64] | None:
    """(4,) x1, y1, x2, y2 in pixels around the part of a solid that lies in the image; None where no part does.

    ``triangles_m`` (T, 3, 3) are in the body's frame."""
    camera_SE3_body = invert_se3(view.ego_SE3_camera) @ ego_SE3_body
    triangles = transform_points(camera_SE3_body, triangles_m.reshape(-1, 3)).reshape(-1, 3, 3) @ view.intrinsics.T
    depth = triangles[..., 2]
    if not len(triangles) or depth.max() < NEAREST_M:
        return None
    size_px = np.array([view.width_px, view.height_px], dtype=np.float64)
    sides = [(np.array([0.0, 0.0, 1.0]), NEAREST_M)]
    for axis in range(2):
        low, high = np.zeros(3), np.zeros(3)
        low[axis], high[axis], high[2] = 1.0, -1.0, size_px[axis]
        sides += [(low, 0.0), (high, 0.0)]
    for normal, least in sides:
        triangles = _cut(triangles, triangles @ normal - least)
    if not len(triangles):
        return None
    pixels = (triangles[..., :2] / triangles[..., 2:]).reshape(-1, 2)
    return np.concatenate([np.clip(pixels.min(axis=0), 0, size_px), np.clip(pixels.max(axis=0), 0, size_px)])


def covered_pixels(
    view: View, ego_SE3_body: NDArray[np.float64], solid: Solid, box_px: NDArray[np.float64], *, at_most: int
) -> NDArray[np.int64]:
    """(N, 2) columns and rows of pixels in ``box_px`` whose centres a solid covers, whether or not anything stands in
    front: of all, or of every n-th column and row so that no more than about ``at_most`` are tried."""
    left, top = (math.floor(value) for value in box_px[:2].tolist())
    right, bottom = (math.ceil(value) for value in box_px[2:].tolist())
    stride = max(1, math.ceil(math.sqrt((right - left) * (bottom - top) / at_most)))
    columns = np.arange(left, min(right, view.width_px), stride, dtype=np.int64)
    rows = np.arange(top, min(bottom, view.height_px), stride, dtype=np.int64)
    pixels = np.stack([np.tile(columns, len(rows)), np.repeat(rows, len(columns))], axis=1)
    if not len(pixels):
        return pixels
    body_SE3_camera = invert_se3(ego_SE3_body) @ view.ego_SE3_camera
    ahead = np.concatenate([pixels + 0.5, np.ones((len(pixels), 1))], axis=1) @ np.linalg.inv(view.intrinsics).T
    directions = ahead @ body_SE3_camera[:3, :3].T
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    origins_m = np.broadcast_to(body_SE3_camera[:3, 3], directions.shape)
    return pixels[solid.cast(origins_m, directions).triangle >= 0]


def _cut(triangles: NDArray[np.float64], side: NDArray[np.float64]) -> NDArray[np.float64]:
    """The parts of (T, 3, 3) triangles where ``side`` (T, 3), linear between their corners, is positive."""
    inside = side >= 0
    count = inside.sum(axis=1)
    kept = [triangles[count == 3]]
    for corners in (1, 2):
        rows = np.flatnonzero(count == corners)
        if not len(rows):
            continue
        odd_one = np.argmax(inside[rows] if corners == 1 else ~inside[rows], axis=1)
        order = (odd_one[:, None] + np.arange(3)) % 3
        a, b, c = (triangles[rows, order[:, k]] for k in range(3))
        side_a, side_b, side_c = (side[rows, order[:, k]][:, None] for k in range(3))
        on_ab = a + (b - a) * (side_a / (side_a - side_b))
        on_ac = a + (c - a) * (side_a / (side_a - side_c))
        if corners == 1:
            kept.append(np.stack([a, on_ab, on_ac], axis=1))
        else:
            kept += [np.stack([on_ab, b, c], axis=1), np.stack([on_ab, c, on_ac], axis=1)]
    return np.concatenate(kept)
