"""Triangles of simple things, to compare with what can be worked out by hand."""

import numpy as np
from numpy.typing import NDArray


def plane(height_m: float, half_side_m: float = 200.0) -> NDArray[np.float64]:
    """(2, 3, 3) a level square around the z axis."""
    a = half_side_m
    corners = np.array([[-a, -a, height_m], [a, -a, height_m], [a, a, height_m], [-a, a, height_m]])
    return corners[np.array([[0, 1, 2], [0, 2, 3]])]


def box(low_m: tuple[float, float, float], high_m: tuple[float, float, float]) -> NDArray[np.float64]:
    """(12, 3, 3) an axis-aligned box."""
    sides = np.array([low_m, high_m])
    corners = np.array([[sides[i, 0], sides[j, 1], sides[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    faces = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
    return corners[np.array([half for a, b, c, d in faces for half in ((a, b, c), (a, c, d))])]
