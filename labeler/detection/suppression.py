"""Non-maximum suppression: of boxes that overlap too much, the best stays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import cv2
import numpy as np
from numpy.typing import NDArray


def suppress(
    xyxy_px: NDArray[np.float32],
    score: NDArray[np.float32],
    group: NDArray[np.int32],
    *,
    iou: float,
    max_candidates: int,
) -> NDArray[np.intp]:
    """Rows that stay, by descending score. Boxes (N, 4) must not be negative.

    A box is dropped when its IoU with a better one of the same ``group`` (N,) is above ``iou``. Only the
    ``max_candidates`` best rows are looked at.
    """
    order = np.argsort(-score, kind="stable")[:max_candidates]
    if len(order) < 2:
        return order
    boxes = xyxy_px[order].astype(np.float64)
    boxes[:, 2:] -= boxes[:, :2]
    # Plain lists cross into OpenCV faster than arrays do: 0.45 ms against 0.75 ms for 300 boxes.
    kept = cv2.dnn.NMSBoxesBatched(
        cast(Sequence[Sequence[float]], boxes.tolist()), score[order].tolist(), group[order].tolist(), 0.0, iou
    )
    return order[np.sort(np.asarray(kept, dtype=np.intp))]
