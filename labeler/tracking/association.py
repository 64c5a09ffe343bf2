"""Which detection feeds which track: overlap with the predicted box, one to one, the best total overlap."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from labeler.geometry.boxes_2d import iou_matrix


def associate(
    track_xyxy_px: NDArray[np.float64],
    detection_xyxy_px: NDArray[np.float64],
    *,
    track_group: NDArray[np.int64],
    detection_group: NDArray[np.int64],
    min_iou: float,
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Pairs of rows (tracks, detections) with the largest total IoU, each row in one pair at most.

    ``track_xyxy_px`` (T, 4) and ``detection_xyxy_px`` (D, 4) in pixels; ``track_group`` (T,) and ``detection_group``
    (D,): only rows of one group pair, and only with an IoU of at least ``min_iou`` (above 0).
    """
    iou = iou_matrix(track_xyxy_px, detection_xyxy_px)
    iou[(iou < min_iou) | (track_group[:, None] != detection_group[None, :])] = 0
    tracks, detections = linear_sum_assignment(iou, maximize=True)
    paired = iou[tracks, detections] > 0
    return tracks[paired], detections[paired]
