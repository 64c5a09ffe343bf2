"""Two tracks on one object: a detector at times boxes an object twice, and each box is followed.

Two objects in one image hide each other before their boxes are almost the same for long, so tracks whose boxes overlap
that much whenever both are there are one object's. The one that was seen better keeps its boxes; the other loses those
that lie on them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.tracking.config import TrackingConfig
from labeler.tracking.pairing import ranges_of

_ON_TOP_IOU = 0.45
"""A double's box lies on the other's where they overlap by as much."""


@dataclass(frozen=True, eq=False)
class SeenBoxes:
    """Boxes of T tracks, a row each: ``track`` (N,) a number, ``frame`` (N,), ``xyxy_px`` (N, 4), ``score`` (N,) with
    NaN where a box was filled in. ``group`` (T,) is the class group of each track."""

    track: NDArray[np.int64]
    frame: NDArray[np.int64]
    xyxy_px: NDArray[np.float64]
    score: NDArray[np.float64]
    group: NDArray[np.int64]


def are_doubles(boxes: SeenBoxes, config: TrackingConfig) -> NDArray[np.bool_]:
    """(N,) whether a box lies on that of another track of the same object, which was seen better."""
    doubles = np.zeros(len(boxes.track), np.bool_)
    a, b, iou = _overlapping(boxes)
    if not len(a):
        return doubles
    tracks = len(boxes.group)
    pair, of_pair = np.unique(boxes.track[a] * tracks + boxes.track[b], return_inverse=True)
    first, second = pair // tracks, pair % tracks
    alike = np.bincount(of_pair, iou >= config.min_iou_double, minlength=len(pair))
    together = _frames_together(boxes, first, second)
    is_double = alike >= np.maximum(config.double_share * together, 1)
    seen = np.bincount(boxes.track, np.nan_to_num(boxes.score), minlength=tracks)
    loses_first = (seen[first] < seen[second]) | ((seen[first] == seen[second]) & (first > second))
    rows = np.where(loses_first[of_pair], a, b)
    doubles[rows[is_double[of_pair]]] = True
    return doubles


def _overlapping(boxes: SeenBoxes) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.float64]]:
    """(P,) and (P,) rows of one image and one group that lie on each other, the one of the smaller track number first,
    and (P,) their IoU."""
    xyxy_px = boxes.xyxy_px
    size_px2 = np.prod(xyxy_px[:, 2:] - xyxy_px[:, :2], axis=1)
    order = np.lexsort((xyxy_px[:, 0], boxes.frame))
    # In a row of all images, image after image: a box can lie on those that begin before it ends.
    first_px = float(xyxy_px[:, 0].min(initial=0))
    width_px = float(xyxy_px[:, 2].max(initial=0)) - first_px + 1
    begin: NDArray[np.float64] = boxes.frame[order] * width_px + xyxy_px[order, 0] - first_px
    end: NDArray[np.float64] = begin + (1 - _ON_TOP_IOU) * (xyxy_px[order, 2] - xyxy_px[order, 0])
    stop = np.searchsorted(begin, end, side="right")
    found: list[tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.float64]]] = []
    for row, place in ranges_of(np.arange(1, len(order) + 1), stop):
        a, b = order[row], order[place]
        sides = np.minimum(xyxy_px[a, 2:], xyxy_px[b, 2:]) - np.maximum(xyxy_px[a, :2], xyxy_px[b, :2])
        shared = np.where((sides > 0).all(axis=1), sides.prod(axis=1), 0.0)
        iou = shared / np.maximum(size_px2[a] + size_px2[b] - shared, 1e-9)
        keep = (iou >= _ON_TOP_IOU) & (boxes.group[boxes.track[a]] == boxes.group[boxes.track[b]])
        a, b = a[keep], b[keep]
        swap = boxes.track[a] > boxes.track[b]
        found.append((np.where(swap, b, a), np.where(swap, a, b), iou[keep]))
    if not found:
        return np.zeros(0, np.intp), np.zeros(0, np.intp), np.zeros(0)
    a, b, iou = (np.concatenate(part) for part in zip(*found, strict=True))
    return a, b, iou


def _frames_together(boxes: SeenBoxes, first: NDArray[np.int64], second: NDArray[np.int64]) -> NDArray[np.int64]:
    """(P,) in how many frames both tracks of each pair have a box."""
    order = np.argsort(boxes.track, kind="stable")
    begin = np.searchsorted(boxes.track[order], np.arange(len(boxes.group) + 1))
    frames = boxes.frame[order]
    of_track = {
        track: frames[begin[track] : begin[track + 1]] for track in np.unique(np.concatenate([first, second])).tolist()
    }
    pairs = zip(first.tolist(), second.tolist(), strict=True)
    return np.array([len(np.intersect1d(of_track[a], of_track[b], assume_unique=True)) for a, b in pairs], np.int64)
