"""How good a pillar network is on drives that it has not seen: average precision seen from above, and its deviations.

The network is judged by itself, before its boxes are given to detections: every box that holds a point that the image
shows, against the vehicles that the image shows and that at least three points above the ground lie on. Other vehicles
absorb the boxes that fall on them. (`hindsight benchmark boxes` judges what comes of it when drives are labelled.)
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from labeler.drive.registry import open_drive
from labeler.evaluation.curves import average_precision
from labeler.geometry.boxes_3d import iou_3d
from labeler.lidar.pillars.decode import PillarBoxes
from labeler.lidar.pillars.direction import SEEN_COLUMN
from labeler.lidar.pillars.network import PillarModel
from labeler.segmentation import Segmenter
from labeler.training.clouds import PILLAR_CLASSES, DirectionSweep, direction_sweeps, points_inside
from labeler.training.errors import TrainingError

_MIN_SCORE = 0.05
_IOU = 0.5
_MAX_DISTANCE_M = 50.0
_DISTANCES_M = (0.0, 10.0, 20.0, 30.0, 40.0, 50.0)


@dataclass(frozen=True)
class PillarResult:
    """Of the vehicles in a scope: how many there are, average precision at a bird's-eye IoU of .5, and of the boxes
    that hit one: the share whose class is right, how far off the middle is in the median, and ``within_deviation``, the
    share that is off along and across by less than one standard deviation together (.39 if errors were normal)."""

    name: str
    truth_count: int
    average_precision: float | None
    right_class: float | None
    median_off_m: float | None
    within_deviation: float | None


@dataclass(frozen=True)
class PillarReport:
    """``directions`` (cameras times sweeps), the ``results`` by scope, and milliseconds of CPU that a direction takes
    the network, from its cloud to its boxes, on one core."""

    model: str
    painted: bool
    drives: tuple[str, ...]
    directions: int
    results: tuple[PillarResult, ...]
    cpu_ms_per_direction: float

    def as_json(self) -> dict[str, Any]:
        return asdict(self)


@dataclass(frozen=True, eq=False)
class _Judged:
    """A box, or a vehicle that was missed (score NaN): the vehicle's distance and class, the box's own where it hits
    none (class -1)."""

    score: NDArray[np.float64]
    is_hit: NDArray[np.bool_]
    distance_m: NDArray[np.float64]
    of_class: NDArray[np.int64]
    right_class: NDArray[np.bool_]
    off_m: NDArray[np.float64]
    off_deviations: NDArray[np.float64]


def validate_pillars(
    model: Path, drives: Sequence[Path], segmenter: Segmenter, advance: Callable[[], None]
) -> PillarReport:
    """Run a pillar network over drives that ``segmenter`` paints; ``advance`` is called after each drive. TrainingError
    when a drive has no truth or the network has other classes, ModelError when the file is no pillar network."""
    network = PillarModel(model)
    if network.class_names != PILLAR_CLASSES:
        raise TrainingError(f"{model} was trained for other classes: {', '.join(network.class_names)}.")
    judged: list[_Judged] = []
    directions, seconds = 0, 0.0
    for folder in drives:
        for sweep in direction_sweeps(open_drive(folder), segmenter):
            cloud = sweep.cloud()
            began = time.thread_time()
            boxes = network.find(cloud, min_score=_MIN_SCORE)
            seconds += time.thread_time() - began
            directions += 1
            judged.append(_judge(_shown(boxes, cloud), sweep))
        advance()
    if not judged:
        raise TrainingError("These drives have no sweep beside an image of a calibrated camera: nothing to find.")
    names = _Judged.__dataclass_fields__
    rows = _Judged(**{name: np.concatenate([getattr(part, name) for part in judged]) for name in names})
    return PillarReport(
        model=model.name,
        painted=network.painted,
        drives=tuple(folder.name for folder in drives),
        directions=directions,
        results=_results(rows),
        cpu_ms_per_direction=1000 * seconds / directions,
    )


def _shown(boxes: PillarBoxes, cloud: NDArray[np.float32]) -> PillarBoxes:
    """The boxes that hold a point that the image shows."""
    seen_m = cloud[cloud[:, SEEN_COLUMN] > 0, :3]
    geometry = np.concatenate([boxes.center_m, boxes.size_m, boxes.yaw_rad[:, None]], axis=1)
    return boxes[np.array([bool(points_inside(seen_m, box, 0.0).any()) for box in geometry], np.bool_)]


def _judge(boxes: PillarBoxes, sweep: DirectionSweep) -> _Judged:
    """The surest box first takes the vehicle that it overlaps most; boxes on vehicles that are not asked for, and boxes
    and vehicles that are too far away, are left out."""
    truth, free = sweep.truth.astype(np.float64), np.ones(len(sweep.truth), np.bool_)
    distance_m = np.hypot(truth[:, 0], truth[:, 1])
    counted = sweep.asked & (distance_m <= _MAX_DISTANCE_M)
    rows: list[tuple[float, bool, float, int, bool, float, float]] = []
    for row in range(len(boxes)):
        iou = np.array([_bev_iou(boxes, row, truth[case]) if free[case] else 0.0 for case in range(len(truth))])
        best = int(iou.argmax()) if len(iou) else -1
        score = float(boxes.score[row])
        if best >= 0 and iou[best] >= _IOU:
            free[best] = False
            if counted[best]:
                of_class = int(sweep.classes[best])
                right = bool(boxes.class_index[row] == of_class)
                rows.append((score, True, distance_m[best], of_class, right, *_off(boxes, row, truth[best])))
        elif (away_m := float(np.hypot(*boxes.center_m[row, :2]))) <= _MAX_DISTANCE_M:
            rows.append((score, False, away_m, -1, False, np.nan, np.nan))
    rows.extend(
        (np.nan, False, distance_m[case], int(sweep.classes[case]), False, np.nan, np.nan)
        for case in np.flatnonzero(counted & free).tolist()
    )
    columns = np.array(rows, np.float64).reshape(-1, 7).T
    return _Judged(
        columns[0], columns[1] > 0, columns[2], columns[3].astype(np.int64), columns[4] > 0, columns[5], columns[6]
    )


def _off(boxes: PillarBoxes, row: int, box: NDArray[np.float64]) -> tuple[float, float]:
    """How far the middle is off, in metres and in standard deviations."""
    off_m = boxes.center_m[row, :2] - box[:2]
    cos, sin = np.cos(boxes.yaw_rad[row]), np.sin(boxes.yaw_rad[row])
    along_m, across_m = cos * off_m[0] + sin * off_m[1], cos * off_m[1] - sin * off_m[0]
    return float(np.hypot(*off_m)), float(np.hypot(along_m / boxes.std[row, 0], across_m / boxes.std[row, 1]))


def _bev_iou(boxes: PillarBoxes, row: int, box: NDArray[np.float64]) -> float:
    if np.hypot(*(boxes.center_m[row, :2] - box[:2])) > np.hypot(*(boxes.size_m[row, :2] + box[3:5])):
        return 0.0
    return iou_3d(boxes.center_m[row], boxes.size_m[row], float(boxes.yaw_rad[row]), box[:3], box[3:6], float(box[6]))[
        1
    ]


def _results(rows: _Judged) -> tuple[PillarResult, ...]:
    """All vehicles, then by distance."""
    scopes = {"within 50 m": np.ones(len(rows.score), np.bool_)}
    for low, high in pairwise(_DISTANCES_M):
        scopes[f"{low:.0f} to {high:.0f} m"] = (rows.distance_m >= low) & (rows.distance_m < high)
    return tuple(_result(name, rows, scope) for name, scope in scopes.items())


def _result(name: str, rows: _Judged, scope: NDArray[np.bool_]) -> PillarResult:
    boxes, hits = scope & np.isfinite(rows.score), scope & rows.is_hit
    truth_count = int(np.count_nonzero(scope & (rows.of_class >= 0)))
    any_hit = bool(hits.any())
    return PillarResult(
        name=name,
        truth_count=truth_count,
        average_precision=average_precision(
            rows.score[boxes].astype(np.float32), rows.is_hit[boxes], truth_count=truth_count
        ),
        right_class=float(rows.right_class[hits].mean()) if any_hit else None,
        median_off_m=float(np.median(rows.off_m[hits])) if any_hit else None,
        within_deviation=float((rows.off_deviations[hits] < 1).mean()) if any_hit else None,
    )
