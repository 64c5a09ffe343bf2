"""What evaluation takes, and what it says.

What it takes are rows of arrays that hold whole images, part by part, so that a drive of any length streams through.
What it says can be written as JSON as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from labeler.errors import HindsightError
from labeler.evaluation.reliability import Reliability
from labeler.propagation import PropagationConfig

METHODS = ("without-tracking", "single-camera", "multi-camera")
TRUTHS = ("whole", "visible")
IOUS = (0.25, 0.5)


class EvaluationError(HindsightError):
    """The drive can't be evaluated, or the settings make no sense: the message says why and what to do."""


@dataclass(frozen=True)
class EvaluationConfig:
    """``confidence``: labels below it are not counted. ``max_distance_m``: truth beyond it is neither hit nor miss, as
    is truth that shows fewer than ``min_visible_pixels``, where that is recorded. ``classes``: "aware" compares
    classes, "agnostic" counts a truck called car as a hit.

    EvaluationError when a value is out of range."""

    confidence: float = 0.8
    max_distance_m: float = 80.0
    min_visible_pixels: int = 30
    classes: str = "aware"

    def __post_init__(self) -> None:
        if not 0 <= self.confidence <= 1:
            raise EvaluationError(f"The confidence must be from 0 to 1, got {self.confidence}.")
        if not self.max_distance_m > 0:
            raise EvaluationError(f"The largest distance must be above 0 m, got {self.max_distance_m}.")
        if self.classes not in ("aware", "agnostic"):
            raise EvaluationError(f'The classes must be counted "aware" or "agnostic", not "{self.classes}".')


@dataclass(frozen=True, eq=False)
class BoxRows:
    """Boxes in images, a row each; all rows of an image are in one part.

    ``frame_index`` (N,) int32; ``camera`` (N,) int16 as an index into the drive's cameras; ``xyxy_px`` (N, 4) float32;
    ``class_id`` (N,) int16 of the detector's class names; ``score`` (N,) float32, NaN where there is none.
    """

    frame_index: NDArray[np.int32]
    camera: NDArray[np.int16]
    xyxy_px: NDArray[np.float32]
    class_id: NDArray[np.int16]
    score: NDArray[np.float32]

    def __post_init__(self) -> None:
        count = len(self.frame_index)
        for name in ("camera", "class_id", "score"):
            if getattr(self, name).shape != (count,):
                raise ValueError(f"BoxRows.{name} must have shape ({count},), got {getattr(self, name).shape}")
        if self.xyxy_px.shape != (count, 4):
            raise ValueError(f"BoxRows.xyxy_px must have shape ({count}, 4), got {self.xyxy_px.shape}")

    def __len__(self) -> int:
        return len(self.frame_index)


@dataclass(frozen=True, eq=False)
class LabelRows:
    """Observations with their labels. ``own`` is each observation as the detector said it, ``track_id`` and
    ``identity_id`` (N,) int32 what it belongs to, ``label_class_id`` (N,) int16 and ``label_score`` (N,) float32 its
    label (NaN where it has no score), ``withheld`` (N,) bool whether it keeps its own label, ``probability`` (N,)
    float32 how likely that label is right (NaN where unknown)."""

    own: BoxRows
    track_id: NDArray[np.int32]
    identity_id: NDArray[np.int32]
    label_class_id: NDArray[np.int16]
    label_score: NDArray[np.float32]
    withheld: NDArray[np.bool_]
    probability: NDArray[np.float32]

    def __post_init__(self) -> None:
        count = len(self.own)
        for name in ("track_id", "identity_id", "label_class_id", "label_score", "withheld", "probability"):
            if getattr(self, name).shape != (count,):
                raise ValueError(f"LabelRows.{name} must have shape ({count},), got {getattr(self, name).shape}")


@dataclass(frozen=True, eq=False)
class EvaluatedLabels:
    """The labels of a drive, from wherever they are kept.

    ``propagation`` are the settings by which labels were given, and ``timestamp_ns`` (F,) is the time of each frame:
    from these follow the labels that tracks have where cameras are not merged. ``open_labels`` and ``open_detections``
    start a pass over the drive in order of frames; the latter is None where the detections are not kept, and then the
    observations' own scores stand for them.
    """

    cameras: tuple[str, ...]
    class_names: tuple[str, ...]
    propagation: PropagationConfig
    timestamp_ns: NDArray[np.int64]
    open_labels: Callable[[], Iterator[LabelRows]]
    open_detections: Callable[[], Iterator[BoxRows]] | None


class Row(TypedDict):
    """A line of the paper's table. Precision is None without labels, recall None without truth."""

    method: str
    cameras: str
    truth: str
    iou: float
    precision: float | None
    recall: float | None
    tp: int
    fp: int
    fn: int


class BinRow(TypedDict):
    """Recall of one method on the truth of one bin, whole boxes, all cameras. ``start`` <= value < ``stop``, the last
    bin with its end."""

    method: str
    iou: float
    start: float
    stop: float
    recall: float | None
    tp: int
    fn: int


class Curve(TypedDict):
    """Precision and recall as the threshold moves from high to low: whole boxes, all cameras, as three equal lists."""

    method: str
    iou: float
    average_precision: float | None
    threshold: list[float]
    precision: list[float]
    recall: list[float]


class Tracking(TypedDict):
    """How well identities hold over all cameras; None where there is neither truth nor label."""

    hota: float | None
    deta: float | None
    assa: float | None
    idf1: float | None
    mota: float | None
    id_switches: int


class MergeCounts(TypedDict):
    """Vehicles that stand in two or more cameras and were found or missed, and identities of several true objects."""

    right: int
    wrong: int
    missed: int


class Calibration(TypedDict):
    """How well it is known which labels are right: multi-camera labels, whole boxes at ``iou``, all cameras; by their
    probability, and by the paper's confidence as if it were one."""

    iou: float
    probability: Reliability
    confidence: Reliability


class Evaluation(TypedDict):
    """What ``hindsight evaluate --json`` prints."""

    drive: str
    confidence: float
    max_distance_m: float
    min_visible_pixels: int
    classes: str
    without_tracking_from: str
    truth_count: int
    dont_care_count: int
    rows: list[Row]
    by_distance: list[BinRow]
    by_visible_share: list[BinRow]
    curves: list[Curve]
    tracking: Tracking
    merges: MergeCounts
    calibration: Calibration
