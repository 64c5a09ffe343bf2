"""What YOLOX puts out, into boxes.

A row of the output is one cell of a grid, for strides 8, 16 and 32 in this order, row by row:
``x, y, width, height, objectness, class probabilities``. *Decoded* models give the box in pixels of the input. *Raw*
models give ``(x + column) * stride`` without the column and the stride, and sizes as ``log(size / stride)``. Both is
official: tools/export_onnx.py of github.com/Megvii-BaseDetection/YOLOX writes raw grids, with ``--decode_in_inference``
decoded ones (equations: get_output_and_grid in yolox/models/yolo_head.py). Scores are probabilities in either.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

STRIDES_PX = (8, 16, 32)


@dataclass(frozen=True, eq=False)
class AnchorGrid:
    """The cell of each output row: ``cell`` (A, 2) float32 column and row, ``stride_px`` (A, 1) float32."""

    cell: NDArray[np.float32]
    stride_px: NDArray[np.float32]

    def __len__(self) -> int:
        return len(self.cell)


@lru_cache(maxsize=32)
def anchor_grid(input_hw: tuple[int, int]) -> AnchorGrid:
    """The grid for an input of this height and width in pixels, both multiples of 32. Read only."""
    cells: list[NDArray[np.float32]] = []
    strides: list[NDArray[np.float32]] = []
    for stride in STRIDES_PX:
        rows, columns = np.indices((input_hw[0] // stride, input_hw[1] // stride), dtype=np.float32)
        cells.append(np.stack([columns.ravel(), rows.ravel()], axis=1))
        strides.append(np.full((rows.size, 1), stride, np.float32))
    grid = AnchorGrid(np.concatenate(cells), np.concatenate(strides))
    grid.cell.flags.writeable = False
    grid.stride_px.flags.writeable = False
    return grid


@dataclass(frozen=True, eq=False)
class Candidates:
    """Boxes before suppression: ``xyxy_px`` (N, 4) float32 in pixels of the input, ``score`` (N,) float32,
    ``model_class`` (N,) int64 index into the model's own classes. ``non_finite`` counts the rows that held NaN or
    infinity and were dropped."""

    xyxy_px: NDArray[np.float32]
    score: NDArray[np.float32]
    model_class: NDArray[np.int64]
    non_finite: int


def find_candidates(
    output: NDArray[np.float32], grid: AnchorGrid, *, decoded: bool, min_score: float, wanted: NDArray[np.bool_]
) -> Candidates:
    """The boxes of one image's output (A, 5 + C) whose best class is ``wanted`` (C,) and scores ``min_score`` or more.

    The score is objectness times the best class's probability. Rows are in the order of the grid."""
    # "not below" instead of "at least", so that NaN stays in, to be counted.
    rows = np.flatnonzero(~(output[:, 4] < min_score))
    best = output[rows]
    model_class = best[:, 5:].argmax(axis=1)
    score = best[:, 4] * best[np.arange(len(rows)), 5 + model_class]
    xyxy_px = _corners(best[:, :4], grid, rows, decoded=decoded)
    finite = np.isfinite(score) & np.isfinite(xyxy_px).all(axis=1)
    keep = finite & (score >= min_score) & wanted[model_class]
    return Candidates(xyxy_px[keep], score[keep], model_class[keep], non_finite=int(len(finite) - finite.sum()))


def _corners(
    box: NDArray[np.float32], grid: AnchorGrid, rows: NDArray[np.intp], *, decoded: bool
) -> NDArray[np.float32]:
    center, size = box[:, :2], box[:, 2:]
    with np.errstate(over="ignore", invalid="ignore"):
        if not decoded:
            stride = grid.stride_px[rows]
            center = (center + grid.cell[rows]) * stride
            size = np.exp(size) * stride
        corners = np.empty((len(rows), 4), np.float32)
        corners[:, :2] = center - size / 2
        corners[:, 2:] = center + size / 2
    return corners


def looks_decoded(output: NDArray[np.float32], grid: AnchorGrid) -> bool:
    """Whether an output (A, 5 + C) holds pixels rather than raw grid values. Rows that are not finite are left out.

    A box lies near its own cell. Read the right way, centres are about one cell away from theirs; read the wrong way,
    as far as the image is large. And sizes in pixels are never negative."""
    finite = np.isfinite(output[:, :4]).all(axis=1)
    center, size = output[finite, :2], output[finite, 2:4]
    if (size < 0).any():
        return False
    from_cell_if_decoded = np.abs(center / grid.stride_px[finite] - grid.cell[finite])
    from_cell_if_raw = np.abs(center)
    return float(np.median(from_cell_if_decoded)) < float(np.median(from_cell_if_raw))
