"""How good are 3D boxes, each camera direction for itself?

A case is a true object in one image: its 3D truth, and the 3D box that belongs to its detection, if there is one. A box
is judged seen from above: how far its centre is off, and its bird's-eye IoU with the truth, which is of the whole
object. An object without a box counts as one with an IoU of 0. Average precision is over all boxes of a direction,
whatever detection they come from, against the true objects in its image.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

from labeler.evaluation.categories import CLASSES
from labeler.evaluation.curves import average_precision

MIN_POINTS = 20
MAX_DISTANCE_M = 40.0
AP_MIN_POINTS = 5
AP_MAX_DISTANCE_M = 50.0
GOOD_IOU = 0.5
_NEAR_M = 0.5

_DISTANCES_M = (0, 10, 20, 40, 60, 80)
_POINTS = (1, 5, 20, 50, 200)


@dataclass(frozen=True, eq=False)
class BoxCases:
    """True objects in images, a row each.

    ``frame_index`` (N,) int32, ``camera`` (N,) int16, ``object_id`` (N,) int32 the same in all images,
    ``category_class`` (N,) int16 as in :mod:`labeler.evaluation.categories`, ``distance_m`` (N,) over the ground,
    ``points`` (N,) int32 LiDAR points in the true box, ``cut`` (N,) bool: its 2D box reaches the image's border,
    ``boxed`` (N,) bool: it has a 3D box; ``error_m`` (N,) how far that one's centre is off seen from above, ``bev_iou``
    (N,), ``yaw_off_rad`` (N,) with front and rear alike, and ``xy_m`` (N, 2) its centre: NaN without a box, but 0 for
    ``bev_iou``.
    """

    frame_index: NDArray[np.int32]
    camera: NDArray[np.int16]
    object_id: NDArray[np.int32]
    category_class: NDArray[np.int16]
    distance_m: NDArray[np.float64]
    points: NDArray[np.int32]
    cut: NDArray[np.bool_]
    boxed: NDArray[np.bool_]
    error_m: NDArray[np.float64]
    bev_iou: NDArray[np.float64]
    yaw_off_rad: NDArray[np.float64]
    xy_m: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.frame_index)

    def __getitem__(self, rows: NDArray[np.bool_] | NDArray[np.intp]) -> BoxCases:
        return BoxCases(**{field.name: getattr(self, field.name)[rows] for field in fields(self)})


@dataclass(frozen=True, eq=False)
class RankedBoxes:
    """All boxes for the average precision: ``score`` (M,) and ``is_hit`` (M,) bool, without those that fall on truth
    that is not counted; ``truth_count`` is how many there were to find."""

    score: NDArray[np.float32]
    is_hit: NDArray[np.bool_]
    truth_count: int


@dataclass(frozen=True)
class BoxScore:
    """``cases`` true objects in images, of which ``boxed`` (a share) have a 3D box. Over those that have one:
    medians and 90th percentile of how far the centre is off, median of the yaw. ``good`` is the share of all cases with
    an IoU of at least .5. None where there is nothing to count."""

    group: str
    cases: int
    boxed: float | None
    median_error_m: float | None
    p90_error_m: float | None
    median_yaw_off_deg: float | None
    good: float | None


@dataclass(frozen=True)
class AgreementScore:
    """Objects that two cameras box in one frame: how many times, the median distance of the two centres, and the share
    of them that are within half a metre of one another."""

    pairs: int
    median_apart_m: float | None
    near: float | None


@dataclass(frozen=True)
class BoxReport:
    """``overall`` are vehicles with at least 20 points within 40 m; ``groups`` split these, or all, in other ways."""

    overall: BoxScore
    groups: tuple[BoxScore, ...]
    agreement: AgreementScore
    average_precision: float | None
    frames: int
    cpu_ms_per_frame: float


def report_boxes(cases: BoxCases, ranked: RankedBoxes, *, frames: int, cpu_ms_per_frame: float) -> BoxReport:
    """All figures of a drive."""
    clear = (cases.points >= MIN_POINTS) & (cases.distance_m <= MAX_DISTANCE_M)
    near = cases.distance_m <= MAX_DISTANCE_M
    seen = cases.points >= 1
    groups = [
        _score("inside of the image", cases[clear & ~cases.cut]),
        _score("cut by the border", cases[clear & cases.cut]),
        *(_score(name, cases[clear & (cases.category_class == number)]) for number, name in enumerate(CLASSES)),
        *(
            _score(f"{low}-{high} m, any points", cases[seen & _between(cases.distance_m, low, high)])
            for low, high in pairwise(_DISTANCES_M)
        ),
        *(
            _score(_points_name(low, high), cases[near & _between(cases.points, low, high)])
            for low, high in zip(_POINTS, (*_POINTS[1:], np.inf), strict=True)
        ),
    ]
    return BoxReport(
        overall=_score("at least 20 points, within 40 m", cases[clear]),
        groups=tuple(group for group in groups if group.cases),
        agreement=_agreement(cases[clear & cases.boxed]),
        average_precision=average_precision(ranked.score, ranked.is_hit, truth_count=ranked.truth_count),
        frames=frames,
        cpu_ms_per_frame=round(cpu_ms_per_frame, 1),
    )


def _score(group: str, cases: BoxCases) -> BoxScore:
    if not len(cases):
        return BoxScore(group, 0, None, None, None, None, None)
    found = cases[cases.boxed]
    return BoxScore(
        group=group,
        cases=len(cases),
        boxed=round(len(found) / len(cases), 4),
        median_error_m=_rounded(np.median(found.error_m)) if len(found) else None,
        p90_error_m=_rounded(np.quantile(found.error_m, 0.9)) if len(found) else None,
        median_yaw_off_deg=_rounded(np.degrees(np.median(found.yaw_off_rad))) if len(found) else None,
        good=round(float(np.mean(cases.bev_iou >= GOOD_IOU)), 4),
    )


def _agreement(boxed: BoxCases) -> AgreementScore:
    rows_of: dict[tuple[int, int], list[int]] = {}
    for row, moment in enumerate(zip(boxed.frame_index.tolist(), boxed.object_id.tolist(), strict=True)):
        rows_of.setdefault(moment, []).append(row)
    pairs = [pair for rows in rows_of.values() for pair in combinations(rows, 2)]
    if not pairs:
        return AgreementScore(0, None, None)
    apart_m = np.array([float(np.hypot(*(boxed.xy_m[a] - boxed.xy_m[b]))) for a, b in pairs])
    return AgreementScore(len(pairs), _rounded(np.median(apart_m)), round(float(np.mean(apart_m < _NEAR_M)), 4))


def _between(value: NDArray[np.float64] | NDArray[np.int32], low: float, high: float) -> NDArray[np.bool_]:
    return np.asarray((value >= low) & (value < high))


def _points_name(low: int, high: float) -> str:
    return f"{low} points and more" if high == np.inf else f"{low}-{int(high) - 1} points"


def _rounded(value: np.floating | float) -> float:
    return round(float(value), 3)
