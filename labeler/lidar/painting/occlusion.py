"""Which points a camera sees past: the LiDAR stands elsewhere than the camera, and meets what is hidden from it.

The nearest depth of each cell of a coarse grid over the image is kept, and a point much deeper than its cell's nearest
is hidden. Cells are taller than wide because LiDAR beams lie farther apart than the readings along them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from labeler.lidar.painting.view import Sight, View

_CELL_PX = (4, 8)
_MARGIN_M = 1.0
_MARGIN_SHARE = 0.05


def hidden_points(sight: Sight, view: View) -> NDArray[np.bool_]:
    """(M,) which of the points in an image are hidden behind nearer ones: by more than a metre and 5 % of the depth,
    so that an object does not hide its own far side.

    The cells to the left and right must hold something as near too: beside the outline of a near object one sees past.
    """
    columns, rows = (side // cell + 1 for side, cell in zip(view.size_px, _CELL_PX, strict=True))
    place = (sight.pixel / np.array(_CELL_PX, np.float32)).astype(np.int32)
    cell = place[:, 1] * columns + place[:, 0]
    nearest_m = np.full(columns * rows, np.inf, np.float32)
    np.minimum.at(nearest_m, cell, sight.depth_m)
    screen_m = ndimage.maximum_filter1d(nearest_m.reshape(rows, columns), 3, axis=1, mode="nearest").ravel()
    return sight.depth_m > screen_m[cell] * np.float32(1 + _MARGIN_SHARE) + np.float32(_MARGIN_M)
