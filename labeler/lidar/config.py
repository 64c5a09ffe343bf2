"""Settings of the LiDAR step, and the sizes that objects of a class usually have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

USUAL_SIZE_M: Mapping[str, tuple[float, float, float]] = MappingProxyType(
    {
        "car": (4.6, 1.9, 1.6),
        "truck": (6.5, 2.3, 2.5),
        "bus": (11.0, 2.6, 3.2),
        "train": (20.0, 3.0, 3.8),
        "motorcycle": (2.1, 0.8, 1.5),
        "bicycle": (1.8, 0.6, 1.5),
        "person": (0.7, 0.7, 1.7),
    }
)
"""Length, width and height in metres of what a class name stands for; an object that is seen larger is larger."""

DEFAULT_SIZE_M = (1.0, 1.0, 1.2)

SIZE_SPREAD: Mapping[str, tuple[float, float, float]] = MappingProxyType(
    {
        "car": (0.1, 0.06, 0.1),
        "truck": (0.3, 0.1, 0.25),
        "bus": (0.2, 0.06, 0.12),
        "train": (0.4, 0.1, 0.1),
        "motorcycle": (0.12, 0.2, 0.15),
        "bicycle": (0.1, 0.2, 0.12),
        "person": (0.3, 0.3, 0.1),
    }
)
"""How far the sizes of a class differ: the standard deviation as a share of the usual length, width and height. A car
is anything from a small one to a van, a truck anything from a pickup to a lorry with a trailer."""

DEFAULT_SPREAD = (0.3, 0.3, 0.3)


@dataclass(frozen=True)
class LidarConfig:
    """How points are painted, split into objects and boxed. Plain values, so that it can be hashed as JSON.

    ``method`` names how boxes are made, see :mod:`labeler.lidar.makers`. Of the method "pillars", ``network`` is the
    network's file (None: the one that ships), and ``fill`` has detections that it has no box for boxed without weights.
    ``min_box_score``: less sure boxes, which are more often wrong than right, are left out.
    ``min_detection_score``: weaker detections paint nothing. ``min_points``: fewer points give no box.
    ``margin``: how far around a box, as a share of its longer side, is looked for what reaches out of it.
    ``max_distance_m``: points farther from the ego origin in x or y are left out.
    ``ground_cell_m``: side of the finest cells of the ground. ``ground_slope``: the steepest ground, as rise over run;
    ``ground_bend``: how much it may rise over the coarser surface for each metre of a cell, and ``ground_tolerance_m``
    beyond that. ``ground_clearance_m``: what is higher above the ground belongs to an object.
    ``cluster_gap_m`` plus ``cluster_gap_per_m`` for each metre of
    distance is the gap that parts two objects seen from above. ``dominance``: a nearer cluster is taken when its paint
    is at least this share of the best cluster's.
    ``yaw_step_deg``, ``closeness_floor_m`` and ``max_fit_points`` govern the search for the yaw.
    """

    method: str = "clusters"
    network: str | None = None
    fill: bool = True
    min_box_score: float = 0.4
    min_detection_score: float = 0.1
    min_points: int = 4
    margin: float = 0.25
    max_distance_m: float = 120.0
    ground_cell_m: float = 2.0
    ground_slope: float = 0.2
    ground_bend: float = 0.05
    ground_tolerance_m: float = 0.1
    ground_clearance_m: float = 0.3
    cluster_gap_m: float = 0.4
    cluster_gap_per_m: float = 0.008
    dominance: float = 0.7
    yaw_step_deg: float = 2.0
    closeness_floor_m: float = 0.1
    max_fit_points: int = 256

    def __post_init__(self) -> None:
        positive = ("max_distance_m", "ground_cell_m", "cluster_gap_m", "yaw_step_deg")
        for name in (*positive, "closeness_floor_m", "max_fit_points", "min_points"):
            if not getattr(self, name) > 0:
                raise ValueError(f"LidarConfig.{name} must be greater than 0, got {getattr(self, name)}")


def usual_sizes_m(class_id: NDArray[np.integer], class_names: tuple[str, ...]) -> NDArray[np.float64]:
    """(N, 3) usual length, width and height of (N,) classes, indices into ``class_names``."""
    table = np.array([USUAL_SIZE_M.get(name, DEFAULT_SIZE_M) for name in class_names] + [DEFAULT_SIZE_M])
    known = (class_id >= 0) & (class_id < len(class_names))
    return table[np.where(known, class_id, len(class_names))]


def size_spreads(class_id: NDArray[np.integer], class_names: tuple[str, ...]) -> NDArray[np.float64]:
    """(N, 3) how far length, width and height of (N,) classes differ, as shares of the usual ones."""
    table = np.array([SIZE_SPREAD.get(name, DEFAULT_SPREAD) for name in class_names] + [DEFAULT_SPREAD])
    known = (class_id >= 0) & (class_id < len(class_names))
    return table[np.where(known, class_id, len(class_names))]
