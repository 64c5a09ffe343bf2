"""How likely a box shows the object that its track is of: not a loose box, another object, or nothing.

A logistic model of a few features that mean the same for any detector, camera and frame rate: seconds, ratios and
overlaps, no pixels and no scores as such. Its curves were fitted on real and on simulated drives with truth
(``python -m labeler.evaluation.calibrate_trust``) and lie in ``trust.json`` beside this module; docs/evaluation.md says
how it does on others.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from importlib import resources

import numpy as np
from numpy.typing import NDArray

from labeler.geometry.boxes_2d import area
from labeler.tracking.curves import CurveModel
from labeler.tracking.pairing import ranges_of

_Array = NDArray[np.float64]

FILE_NAME = "trust.json"
FEATURES = (
    "relative_score",
    "filled",
    "on_path",
    "since_sure",
    "length",
    "covered",
    "narrower",
    "flatter",
    "near_scores",
    "from_end",
)
"""In order: the score as a share of the track's best (0 if filled in); 1 if filled in; IoU of the detected box with the
smooth one (0 if filled in); log of 1 plus tenths of a second to the track's nearest sure detection, one with at least
nine tenths of its best score; log of 1 plus the track's length in seconds; the largest share of the box that a box of
another track covers; how much narrower, and how much flatter, the box is than those of its track that are sure (in logs
of width by height); the mean relative score of the track's boxes within half a second; log of 1 plus tenths of a second
to the track's nearer end."""

_LEAST_SHARE_OF_BEST = 0.9
_LONGEST_S = 10.0
_NEAR_S = 0.5
_SURE_POWER, _LEAST_WEIGHT = 4, 1e-9


@dataclass(frozen=True, eq=False)
class JudgedBoxes:
    """Boxes of tracks to judge, a row each, by ``track``, then ``time_s`` (N,).

    ``frame`` (N,) tells which are in one image; ``score`` (N,) is NaN and ``on_path`` (N,) 0 where a box was filled in;
    ``xyxy_px`` (N, 4)."""

    track: NDArray[np.int64]
    frame: NDArray[np.int64]
    time_s: _Array
    score: _Array
    on_path: _Array
    xyxy_px: _Array


def features_of(boxes: JudgedBoxes) -> _Array:
    """(N, F) the FEATURES of each box."""
    if len(boxes.track) == 0:
        return np.zeros((0, len(FEATURES)))
    filled = np.isnan(boxes.score)
    score = np.where(filled, 0.0, boxes.score)
    starts = np.flatnonzero(np.diff(boxes.track, prepend=-1))
    place = np.repeat(np.arange(len(starts)), np.diff(np.append(starts, len(score))))
    best = np.maximum.reduceat(score, starts)[place]
    relative = np.divide(score, best, out=np.zeros(len(score)), where=best > 0)
    since_first_s = boxes.time_s - boxes.time_s[starts][place]
    length_s = np.maximum.reduceat(since_first_s, starts)[place]
    sides = np.maximum(boxes.xyxy_px[:, 2:] - boxes.xyxy_px[:, :2], 1.0)
    log_aspect = np.log(sides[:, 0] / sides[:, 1])
    of_sure = np.maximum(relative**_SURE_POWER, _LEAST_WEIGHT)
    usual = np.add.reduceat(of_sure * log_aspect, starts) / np.add.reduceat(of_sure, starts)
    wider = log_aspect - usual[place]
    columns = (
        relative,
        filled.astype(np.float64),
        boxes.on_path,
        np.log1p(10 * _time_to_nearest(boxes, place, score >= _LEAST_SHARE_OF_BEST * best)),
        np.log1p(np.minimum(length_s, _LONGEST_S)),
        _covered_shares(boxes),
        np.maximum(0.0, -wider),
        np.maximum(0.0, wider),
        _means_near(relative, place, since_first_s),
        np.log1p(10 * np.minimum(since_first_s, length_s - since_first_s)),
    )
    return np.stack(columns, axis=1)


def trust_of(features: _Array, model: CurveModel | None = None) -> _Array:
    """(N,) probability for each row of FEATURES (N, F), by the model that ships unless another is given."""
    return (model or shipped()).probability(features, FEATURES)


@cache
def shipped() -> CurveModel:
    """The model that lies beside this module."""
    return CurveModel.from_json(json.loads(shipped_text()))


def shipped_text() -> str:
    """Its content: what depends on the model is keyed by it."""
    return (resources.files("labeler.tracking") / FILE_NAME).read_text(encoding="utf-8")


def _means_near(values: _Array, place: NDArray[np.intp], time_s: _Array) -> _Array:
    """(N,) mean of the values (N,) of the same track within ``_NEAR_S``; ``time_s`` (N,) counts from its beginning."""
    apart = float(time_s.max()) + 3 * _NEAR_S
    at = place * apart + time_s  # one row of time, track after track
    low = np.searchsorted(at, at - _NEAR_S * (1 + 1e-9), side="left")
    high = np.searchsorted(at, at + _NEAR_S * (1 + 1e-9), side="right")
    total = np.concatenate([np.zeros(1), np.cumsum(values)])
    return (total[high] - total[low]) / (high - low)


def _time_to_nearest(boxes: JudgedBoxes, place: NDArray[np.intp], sure: NDArray[np.bool_]) -> _Array:
    """(N,) seconds to the nearest sure row of the same track; each track has one, that of its best score."""
    row = np.arange(len(sure))
    before = np.maximum.accumulate(np.where(sure, row, -1))
    after = np.minimum.accumulate(np.where(sure, row, len(sure))[::-1])[::-1]
    nearest = np.full(len(sure), np.inf)
    for other, exists in ((before, before >= 0), (after, after < len(sure))):
        other = np.where(exists, other, 0)
        same = exists & (place[other] == place)
        nearest = np.where(same, np.minimum(nearest, np.abs(boxes.time_s - boxes.time_s[other])), nearest)
    return nearest


def _covered_shares(boxes: JudgedBoxes) -> _Array:
    """(N,) the largest share of each box that one of another track covers in the same image."""
    xyxy_px = boxes.xyxy_px
    left, right = _places_from_left(boxes)
    order = np.argsort(left, kind="stable")
    begins = left[order]
    covered = np.zeros(len(left))
    # of two boxes that overlap one begins inside the other: between the first's left side and its right one
    for row, place in ranges_of(np.arange(1, len(left) + 1), np.searchsorted(begins, right[order])):
        a, b = order[row], order[place]
        sides = np.minimum(xyxy_px[a, 2:], xyxy_px[b, 2:]) - np.maximum(xyxy_px[a, :2], xyxy_px[b, :2])
        over = (sides > 0).all(axis=1)
        shared = sides[over].prod(axis=1)
        np.maximum.at(covered, a[over], shared)
        np.maximum.at(covered, b[over], shared)
    return np.minimum(covered / np.maximum(area(xyxy_px), 1e-9), 1.0)


def _places_from_left(boxes: JudgedBoxes) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """(N,) and (N,) the places of each box's left and right side in a row of all sides, image after image, from left to
    right. Where sides of one image lie at the same x, right ones come first, since these boxes only touch."""
    count = len(boxes.frame)
    x_px = np.concatenate([boxes.xyxy_px[:, 0], boxes.xyxy_px[:, 2]])
    is_left = np.repeat([1, 0], count)
    place = np.empty(2 * count, np.int64)
    place[np.lexsort((is_left, x_px, np.tile(boxes.frame, 2)))] = np.arange(2 * count)
    return place[:count], place[count:]
