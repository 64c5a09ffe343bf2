"""What a segmentation network says about an image."""

from __future__ import annotations

from collections.abc import Sequence
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
        return self.sums_at(pixels, [(plane,) for plane in range(len(self.class_names))])

    def sums_at(self, pixels: NDArray[np.floating], groups: Sequence[Sequence[int]]) -> NDArray[np.float32]:
        """(N, G) float32 sums of the scores of each of G groups of classes, by number; places as for :meth:`at`."""
        if pixels.ndim != 2 or pixels.shape[1] != 2:
            raise ValueError(f"pixels must be (N, 2), got {pixels.shape}")
        found = np.zeros((len(pixels), len(groups)), np.float32)
        width, height = self.size_px
        x, y = pixels[:, 0], pixels[:, 1]
        inside = np.flatnonzero((x >= 0) & (x < width) & (y >= 0) & (y < height))
        rows, columns = self.scores.shape[1:]
        column, right = _cell_and_share(x[inside], self.stride_px, columns)
        row, below = _cell_and_share(y[inside], self.stride_px, rows)
        corner = row * columns + column
        to_right, to_below = np.where(column < columns - 1, 1, 0), np.where(row < rows - 1, columns, 0)
        for number, group in enumerate(groups):
            plane = self.scores[list(group)].sum(axis=0, dtype=np.float32).ravel()
            upper = _between(plane[corner], plane[corner + to_right], right)
            lower = _between(plane[corner + to_below], plane[corner + to_below + to_right], right)
            found[inside, number] = _between(upper, lower, below) / np.float32(_CERTAIN)
        return found

    def class_index(self, name: str) -> int | None:
        """The plane of the class of that name, without regard to case; None where there is none."""
        for index, known in enumerate(self.class_names):
            if known.lower() == name.lower():
                return index
        return None


def _cell_and_share(
    place_px: NDArray[np.floating], stride_px: float, cells: int
) -> tuple[NDArray[np.intp], NDArray[np.float32]]:
    """Between the centres of which cells (N,) coordinates lie: the lower one, and the share of the way to the next."""
    place = np.clip(place_px.astype(np.float32) / np.float32(stride_px) - np.float32(0.5), 0, cells - 1)
    low = place.astype(np.intp)
    return low, (place - low).astype(np.float32)


def _between(low: NDArray[np.float32], high: NDArray[np.float32], share: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.asarray(low + (high - low) * share, np.float32)
