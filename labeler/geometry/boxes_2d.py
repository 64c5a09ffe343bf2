"""Axis-aligned boxes in images as rows ``x1, y1, x2, y2`` in pixels."""

import numpy as np
from numpy.typing import NDArray


def area(xyxy: NDArray[np.floating]) -> NDArray[np.floating]:
    """(N,) areas of (N, 4) boxes; a box with a negative side has area 0."""
    return np.clip(xyxy[:, 2] - xyxy[:, 0], 0, None) * np.clip(xyxy[:, 3] - xyxy[:, 1], 0, None)


def intersection_matrix(a: NDArray[np.floating], b: NDArray[np.floating]) -> NDArray[np.floating]:
    """(A, B) areas of the pairwise intersections of (A, 4) and (B, 4) boxes."""
    upper_left = np.maximum(a[:, None, :2], b[None, :, :2])
    lower_right = np.minimum(a[:, None, 2:], b[None, :, 2:])
    sides = np.clip(lower_right - upper_left, 0, None)
    return sides[..., 0] * sides[..., 1]


def iou_matrix(a: NDArray[np.floating], b: NDArray[np.floating]) -> NDArray[np.floating]:
    """(A, B) intersection over union of (A, 4) and (B, 4) boxes; 0 where both boxes are empty."""
    intersection = intersection_matrix(a, b)
    union = area(a)[:, None] + area(b)[None, :] - intersection
    zeros = np.zeros(union.shape, dtype=np.result_type(union, np.float32))  # whole numbers divide to fractions too
    return np.divide(intersection, union, out=zeros, where=union > 0)
