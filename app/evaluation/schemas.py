"""What the page learns about how good labels are: what ``hindsight evaluate --json`` prints, typed."""

from enum import StrEnum

from pydantic import BaseModel, Field


class Method(StrEnum):
    """The detector alone, tracks inside each camera, identities over all cameras."""

    WITHOUT_TRACKING = "without-tracking"
    SINGLE_CAMERA = "single-camera"
    MULTI_CAMERA = "multi-camera"


class CameraGroup(StrEnum):
    ALL = "all"
    FRONT = "front"


class TruthKind(StrEnum):
    """Boxes of whole objects, or of their visible parts."""

    WHOLE = "whole"
    VISIBLE = "visible"


class ClassMode(StrEnum):
    AWARE = "aware"
    AGNOSTIC = "agnostic"


class TableRow(BaseModel):
    """A line of the table; precision is null without labels, recall without truth."""

    method: Method
    cameras: CameraGroup
    truth: TruthKind
    iou: float
    precision: float | None
    recall: float | None
    tp: int
    fp: int
    fn: int


class BinRecall(BaseModel):
    """Recall of whole boxes over all cameras, of the objects whose value lies from start to stop."""

    method: Method
    iou: float
    start: float
    stop: float
    recall: float | None
    tp: int
    fn: int


class PrecisionRecallCurve(BaseModel):
    """Precision and recall of whole boxes over all cameras, by threshold."""

    method: Method
    iou: float
    average_precision: float | None
    threshold: list[float]
    precision: list[float]
    recall: list[float]


class TrackingScores(BaseModel):
    """How well identities hold over all cameras; null where there is neither truth nor label."""

    hota: float | None
    deta: float | None
    assa: float | None
    idf1: float | None
    mota: float | None
    id_switches: int


class MergeScores(BaseModel):
    """Vehicles in two or more cameras that were found or missed, and identities of several true objects."""

    right: int
    wrong: int
    missed: int


class ReliabilityStep(BaseModel):
    """Labels that say of themselves what lies between start and stop: how many, their mean, and how many are right."""

    start: float
    stop: float
    labels: int
    predicted: float | None
    observed: float | None


class Reliability(BaseModel):
    """How well labels know whether they are right; the expected calibration error is null without labels."""

    labels: int
    expected_error: float | None
    bins: list[ReliabilityStep]


class Calibration(BaseModel):
    """Reliability of the labels' probability, and of the paper's confidence taken for one."""

    iou: float
    probability: Reliability
    confidence: Reliability


class Evaluation(BaseModel):
    """How the labels of a drive compare with its truth."""

    drive: str
    confidence: float
    max_distance_m: float
    min_visible_pixels: int
    classes: ClassMode
    without_tracking_from: str = Field(
        description='"detections", or "observations" where the detections are not kept: then those in tracks only.'
    )
    truth_count: int = Field(description="True objects that count, one for each image.")
    dont_care_count: int = Field(description="Regions and objects that are neither hit nor miss.")
    rows: list[TableRow]
    by_distance: list[BinRecall] = Field(description="Bins in metres.")
    by_visible_share: list[BinRecall] = Field(description="Bins from 0 to 1; empty where the share is not known.")
    curves: list[PrecisionRecallCurve]
    tracking: TrackingScores
    merges: MergeScores
    calibration: Calibration
