"""What a segmentation network says about an image."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_CERTAIN = 255


@dataclass(frozen=True, eq=False)
class SegmentationScores:
    """How surely each cell of a grid over one image shows each class.

    ``class_names`` names the C classes. ``scores`` is (C, h, w) uint8: 0 is a probability of 0, 255 one of 1, so the
    classes of a cell sum to about 255. ``stride_px`` is the side of a cell in pixels of the image as it was recorded
    (not a whole number where the network saw a smaller image): the cell of row i and column j covers x from
    j * stride_px to (j + 1) * stride_px, and y likewise by its row. ``size_px`` is the width and height of the image;
    the grid covers all of it, and its last row and column may reach beyond.

    Used by the LiDAR step: project a sweep's points into the image and call :meth:`at` with their pixels.
    """

    class_names: tuple[str, ...]
    scores: NDArray[np.uint8]
    stride_px: float
    size_px: tuple[int, int]

    def __post_init__(self) -> None:
        if self.scores.dtype != np.uint8 or self.scores.ndim != 3 or len(self.scores) != len(self.class_names):
            raise ValueError(
                f"SegmentationScores.scores must be ({len(self.class_names)}, h, w) uint8, a plane for each class, "
                f"got {self.scores.shape} {self.scores.dtype}"
            )
        if not 0 < self.stride_px < np.inf:
            raise ValueError(f"SegmentationScores.stride_px must be above 0, got {self.stride_px}")
        covered_px = self.scores.shape[2] * self.stride_px, self.scores.shape[1] * self.stride_px
        if min(self.size_px) < 1 or covered_px[0] < self.size_px[0] or covered_px[1] < self.size_px[1]:
            raise ValueError(
                f"SegmentationScores: {self.scores.shape[1]} rows and {self.scores.shape[2]} columns of cells of "
                f"{self.stride_px} px do not cover an image of {self.size_px[0]}x{self.size_px[1]} px"
            )

    def at(self, pixels: NDArray[np.floating]) -> NDArray[np.float32]:
        """(N, C) float32 scores in 0..1 at (N, 2) places x, y in pixels, from the image's upper left corner.

        Between the centres of cells the scores are interpolated (bilinear). A place outside of the image, or one that
        is not finite, scores 0 in every class.
        """
        if pixels.ndim != 2 or pixels.shape[1] != 2:
            raise ValueError(f"pixels must be (N, 2), got {pixels.shape}")
        found = np.zeros((len(pixels), len(self.class_names)), np.float32)
        inside = np.flatnonzero(((pixels >= 0) & (pixels < np.array(self.size_px))).all(axis=1))
        last = np.array(self.scores.shape[:0:-1]) - 1
        cell = np.clip(pixels[inside].astype(np.float32) / np.float32(self.stride_px) - np.float32(0.5), 0, last)
        low = cell.astype(np.intp)
        (x1, y1), (x2, y2) = low.T, np.minimum(low + 1, last).T
        right, below = (cell - low).astype(np.float32).T
        upper = self.scores[:, y1, x1] * (1 - right) + self.scores[:, y1, x2] * right
        lower = self.scores[:, y2, x1] * (1 - right) + self.scores[:, y2, x2] * right
        found[inside] = ((upper * (1 - below) + lower * below) / np.float32(_CERTAIN)).T
        return found

    def class_index(self, name: str) -> int | None:
        """The plane of the class of that name, without regard to case; None where there is none."""
        for index, known in enumerate(self.class_names):
            if known.lower() == name.lower():
                return index
        return None
