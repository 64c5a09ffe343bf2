"""What colours an object shows: evidence that needs no place in 3D, and outlasts any gap.

A histogram over the inner part of a box, in CIELAB: fine in hue, coarse in lightness, since cameras expose differently.
Each pixel is shared between the bins around it. Of a track, the mean over its best looks counts, and two tracks are as
alike as the Bhattacharyya coefficient of their histograms. Source: Comaniciu, Ramesh and Meer, Kernel-based object
tracking, PAMI 2003, eq. 4 to 8.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import NDArray

from labeler.tracking.types import NO_DETECTION, Observations

_LIGHTNESS = np.array([20.0, 50.0, 80.0])
_HUE = np.array([-40.0, -20.0, -8.0, 0.0, 8.0, 20.0, 40.0])
BINS = len(_LIGHTNESS) * len(_HUE) ** 2

LOOKS_PER_TRACK = 8
_MARGIN = 0.2
"""So much of a box's width and height on each side is left out: there the background shows."""
_SIDE_PX = 12
_LEAST_PX = 2
_BIG_ENOUGH_PX2 = 5000.0
"""A box that is larger than this shows its colours no better."""


@dataclass(frozen=True, order=True)
class Look:
    """One box of a track: its four coordinates ``xyxy_px`` in an image of its camera. Of two looks, the one with the
    larger ``worth`` shows the colours better."""

    worth: float
    frame_index: int
    xyxy_px: tuple[float, ...] = field(compare=False)


def best_looks(parts: Iterable[Observations]) -> dict[int, list[Look]]:
    """The boxes of each track that show its colours best, a few of each: large ones that the detector was sure of."""
    kept: dict[int, list[Look]] = {}
    for part in parts:
        rows = np.flatnonzero((part.detection_index != NO_DETECTION) & np.isfinite(part.score))
        size_px = np.maximum(part.xyxy_px[rows, 2:] - part.xyxy_px[rows, :2], 0).astype(np.float64)
        worth = part.score[rows] * np.minimum(size_px.prod(axis=1), _BIG_ENOUGH_PX2)
        frames, boxes = part.frame_index[rows].tolist(), part.xyxy_px[rows].tolist()
        for track, value, frame, box in zip(part.track_id[rows].tolist(), worth.tolist(), frames, boxes, strict=True):
            looks = kept.setdefault(track, [])
            add = heapq.heappush if len(looks) < LOOKS_PER_TRACK else heapq.heappushpop
            add(looks, Look(value, frame, tuple(box)))
    return kept


def colour_histogram(image: NDArray[np.uint8], xyxy_px: Sequence[float]) -> NDArray[np.float32] | None:
    """(BINS,) shares of the colours inside of a box, that add up to 1. ``image`` (H, W, 3) is in BGR order. None where
    less than two pixels of the box's inner part lie in the image, in width or height."""
    x1, y1, x2, y2 = xyxy_px
    margin_x, margin_y = _MARGIN * (x2 - x1), _MARGIN * (y2 - y1)
    height, width = image.shape[:2]
    left, right = max(0, math.floor(x1 + margin_x)), min(width, math.ceil(x2 - margin_x))
    top, bottom = max(0, math.floor(y1 + margin_y)), min(height, math.ceil(y2 - margin_y))
    if right - left < _LEAST_PX or bottom - top < _LEAST_PX:
        return None
    inner = cv2.resize(image[top:bottom, left:right], (_SIDE_PX, _SIDE_PX), interpolation=cv2.INTER_AREA)
    pixels = cv2.cvtColor(inner.astype(np.float32) / 255, cv2.COLOR_BGR2LAB).reshape(-1, 3).astype(np.float64)
    of_lightness, of_a, of_b = (
        _shared(pixels[:, 0], _LIGHTNESS),
        _shared(pixels[:, 1], _HUE),
        _shared(pixels[:, 2], _HUE),
    )
    histogram = np.einsum("ni,nj,nk->ijk", of_lightness, of_a, of_b).ravel() / len(pixels)
    return histogram.astype(np.float32)


def likeness(a: NDArray[np.float32] | None, b: NDArray[np.float32] | None) -> float:
    """The Bhattacharyya coefficient of two histograms (BINS,), from 0 to 1; NaN where one is not known."""
    return math.nan if a is None or b is None else float(np.sqrt(a * b).sum())


def _shared(value: NDArray[np.float64], middles: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, K) how much of each value belongs to each bin, by linear interpolation between the bins' middles."""
    inside = np.clip(value, middles[0], middles[-1])
    right = np.clip(np.searchsorted(middles, inside, side="right"), 1, len(middles) - 1)
    share = (inside - middles[right - 1]) / (middles[right] - middles[right - 1])
    shares = np.zeros((len(value), len(middles)))
    rows = np.arange(len(value))
    shares[rows, right - 1], shares[rows, right] = 1 - share, share
    return shares
