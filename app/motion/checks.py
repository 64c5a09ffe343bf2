"""Physics checks: what no single object can do, so that two must have been taken for one, or a box is loose.

Limits are those of the world, wide enough for boxes that LiDAR shows only in part: a check that fails is a reason to
look, not a verdict. Without poses nobody knows how the car moved, so speeds and turns are not checked.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from app.motion.paths import BoxPath, PathFrame


class Check(StrEnum):
    """What can be wrong with an identity."""

    SPEED = "speed"
    """It moves faster than its class can."""
    SIZE = "size"
    """Its 3D boxes are now small, now large."""
    YAW = "yaw"
    """It turns on the spot, from one moment to the next."""
    TWICE = "twice"
    """It is in one image of a camera twice."""


@dataclass(frozen=True)
class Failure:
    """A check that fails: ``value`` in ``unit``, at its worst in ``frame_index``."""

    check: Check
    value: float
    unit: str
    frame_index: int


WALKING = frozenset({"person", "pedestrian", "dog", "cat"})
CYCLING = frozenset({"bicycle", "cyclist", "rider"})
MAX_SPEED_MPS = {"walking": 12.0, "cycling": 25.0, "driving": 70.0}
"""A sprinter, a racing cyclist downhill, and a car at 250 km/h."""
SPEED_OVER_S = (0.5, 1.5)
"""Speeds are taken over this long: shorter, and a box that LiDAR shows in part now and whole then is fast."""
MAX_SIZE_RATIO = 3.0
"""Of the diagonals seen from above. A car seen from behind and then whole is 2.5 times as large."""
SIZE_BOXES = 8
MAX_TURN_DEG = 60.0
TURN_BOXES = 3
TURN_GAP_S = 0.35


def failures(paths: Sequence[BoxPath], class_name: str, shared_frame: int | None) -> list[Failure]:
    """The checks that an identity fails, of the ways of its tracks.

    ``shared_frame`` is a frame in which two of its tracks are in one image, None where there is none."""
    found = [_size(paths)]
    if all(path.frame is PathFrame.CITY for path in paths):
        found += [_speed(paths, class_name), _turn(paths)]
    if shared_frame is not None:
        found.append(Failure(Check.TWICE, 2, "boxes", shared_frame))
    return [failure for failure in found if failure is not None]


def _speed(paths: Sequence[BoxPath], class_name: str) -> Failure | None:
    """The fastest move from one place to another, of all tracks together: a wrong merge jumps between them."""
    if not paths:
        return None
    time_s = np.concatenate([path.time_s for path in paths])
    frame = np.concatenate([path.frame_index for path in paths])
    xy_m = np.concatenate([path.xy_m for path in paths])
    order = np.argsort(time_s, kind="stable")
    time_s, frame, xy_m = time_s[order], frame[order], xy_m[order]
    later = np.searchsorted(time_s, time_s + SPEED_OVER_S[0] - 1e-6)
    rows = np.flatnonzero(later < len(time_s))
    later = later[rows]
    duration_s = time_s[later] - time_s[rows]
    near = duration_s <= SPEED_OVER_S[1]
    rows, later, duration_s = rows[near], later[near], duration_s[near]
    if not len(rows):
        return None
    speed = (np.hypot(*(xy_m[later] - xy_m[rows]).T) / duration_s).round(3)
    worst = int(np.argmax(speed))
    if speed[worst] <= MAX_SPEED_MPS[_way_of_moving(class_name)]:
        return None
    return Failure(Check.SPEED, round(float(speed[worst]), 1), "m/s", int(frame[later[worst]]))


def _way_of_moving(class_name: str) -> str:
    name = class_name.lower()
    return "walking" if name in WALKING else "cycling" if name in CYCLING else "driving"


def _size(paths: Sequence[BoxPath]) -> Failure | None:
    """Diagonals seen from above, the largest tenth and the smallest tenth left out."""
    if sum(len(path) for path in paths) < SIZE_BOXES:
        return None
    diagonal_m = np.concatenate([np.hypot(path.size_m[:, 0], path.size_m[:, 1]) for path in paths])
    frame = np.concatenate([path.frame_index for path in paths])
    small, large = _quantiles(diagonal_m, (0.1, 0.9))
    if small <= 0 or large / small <= MAX_SIZE_RATIO:
        return None
    return Failure(Check.SIZE, round(float(large / small), 1), "times", int(frame[int(np.argmax(diagonal_m))]))


def _quantiles(values: NDArray[np.float64], shares: Sequence[float]) -> list[float]:
    """As ``np.quantile`` gives them, which takes most of the time for a few values."""
    ordered = np.sort(values)
    at = np.asarray(shares) * (len(ordered) - 1)
    return np.interp(at, np.arange(len(ordered)), ordered).tolist()


def _turn(paths: Sequence[BoxPath]) -> Failure | None:
    """The largest turn inside a track between the few boxes before a moment and the few after it.

    Front and rear of a box can't be told, so angles count by half turns."""
    worst: Failure | None = None
    for path in paths:
        count = len(path)
        if count < 2 * TURN_BOXES:
            continue
        doubled = np.exp(2j * path.yaw_rad)
        sums = np.concatenate([[0], np.cumsum(doubled)])
        means = sums[TURN_BOXES:] - sums[:-TURN_BOXES]  # of the boxes from each row on
        before, after = means[: count - 2 * TURN_BOXES + 1], means[TURN_BOXES:]
        turn_deg = np.abs(np.degrees(np.angle(after * np.conj(before)))) / 2
        steady = (np.abs(before) > 0.8 * TURN_BOXES) & (np.abs(after) > 0.8 * TURN_BOXES)
        gap_s = path.time_s[TURN_BOXES : count - TURN_BOXES + 1] - path.time_s[TURN_BOXES - 1 : count - TURN_BOXES]
        turn_deg = np.where(steady & (gap_s <= TURN_GAP_S), turn_deg, 0.0)
        row = int(np.argmax(turn_deg))
        value = float(turn_deg[row])
        if value > MAX_TURN_DEG and (worst is None or value > worst.value):
            worst = Failure(Check.YAW, round(value, 0), "degrees", int(path.frame_index[row + TURN_BOXES]))
    return worst


def distances_m(paths: Sequence[BoxPath]) -> tuple[float | None, float | None]:
    """The nearest and the farthest distance from the car; None without 3D boxes."""
    if not paths:
        return None, None
    distance: NDArray[np.float64] = np.concatenate([path.ego_distance_m for path in paths])
    return round(float(distance.min()), 1), round(float(distance.max()), 1)
