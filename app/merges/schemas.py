"""What the page learns about merges."""

from enum import StrEnum

from pydantic import BaseModel, Field

from app.edits.schemas import Revision
from app.motion.paths import PathFrame


class MergeState(StrEnum):
    PROPOSED = "proposed"
    ACCEPTED = "accepted"
    REJECTED = "rejected"
    UNSURE = "unsure"
    """A person could not tell: the tracks stay apart until somebody can."""


class DecidedBy(StrEnum):
    MACHINE = "machine"
    PERSON = "person"


class MergeFrame(BaseModel):
    """The evidence of one frame in which both tracks have a 3D box."""

    frame_index: int
    distance_m: float
    bev_iou: float
    iou_3d: float


class MergeFeature(BaseModel):
    """One thing that was measured about two tracks."""

    name: str
    value: float
    unit: str
    log_odds: float = Field(description="What it adds to the log odds: above 0 it speaks for one object.")


class MergePlot(BaseModel):
    """Both tracks from above, in metres, in the ego frame (x forward, y left) of ``reference_frame``."""

    reference_frame: int
    ego: list[list[float]] = Field(description="Frame, x, y and yaw of the recording car.")
    track_a: list[list[float]] = Field(description="Frame, x, y and standard deviation of the smoothed trajectory.")
    track_b: list[list[float]]
    boxes_a: list[list[float]] = Field(
        description="Frame, x, y, length, width and yaw of 3D boxes in frames that tell most."
    )
    boxes_b: list[list[float]]


class MergeKind(StrEnum):
    """Seen by two cameras at the same time, by two cameras one after the other, or lost and found in one camera."""

    OVERLAP = "overlap"
    HANDOVER = "handover"
    FRAGMENT = "fragment"


class MergeEvidence(BaseModel):
    """What the score of a merge is made of."""

    kind: MergeKind
    calibrated: bool = Field(
        description="Whether the score is a probability: the logistic function of bias_log_odds plus the log_odds of "
        "all features."
    )
    gap_s: float = Field(description="Between the end of one track and the beginning of the other, else 0.")
    gap_frames: list[int] | None = Field(description="The last frame of the one and the first of the other.")
    features: list[MergeFeature]
    bias_log_odds: float


class Merge(BaseModel):
    """A claim that two tracks are one object, with its evidence."""

    id: int
    track_a: int
    track_b: int
    camera_a: str
    camera_b: str
    score: float
    probability: float | None = Field(
        description="How likely it is that both tracks are one object, from 0 to 1; null where the score is none: see "
        "evidence.calibrated."
    )
    state: MergeState
    decided_by: DecidedBy
    shared_frames: int
    agreeing_frames: int
    mean_distance_m: float | None = Field(description="Over agreeing frames; null without any.")
    mean_bev_iou: float | None = Field(description="Over the best frames; null without an agreeing one.")
    reason: str
    best_frames: list[MergeFrame]
    evidence: MergeEvidence | None = Field(description="Null for a merge that the machine has not measured.")
    label_count: int = Field(description="How many labels accepting or undoing it changes.")
    priority: float = Field(
        description="Impact times uncertainty: label_count times the entropy of the score in bits, 1 at .5 and 0 at 0 "
        "and 1. The queue goes from high to low."
    )
    identity_a: int
    identity_b: int


class MergeDecision(BaseModel):
    """What comes with a decision about a merge."""

    revision: Revision = None


class Look(BaseModel):
    """A track in one image, as the detector saw it; ``score`` is null where the tracker filled the box in."""

    track_id: int
    identity_id: int
    camera: str
    frame_index: int
    box: tuple[float, float, float, float] = Field(description="x1, y1, x2, y2 in pixels of the original image.")
    class_name: str
    score: float | None


class Way(BaseModel):
    """Places in order of time, seen from above, a value each in every column; the car's own has no sizes."""

    frame_index: list[int] = []
    x_m: list[float] = []
    y_m: list[float] = []
    yaw_rad: list[float] = []
    length_m: list[float] = []
    width_m: list[float] = []


class MergeSide(BaseModel):
    """One of the two tracks of a merge; ``way`` is empty where it has no 3D box."""

    track_id: int
    identity_id: int
    camera: str
    class_name: str
    first_frame: int
    last_frame: int
    best: Look
    way: Way


class Moment(BaseModel):
    """Both tracks at the same time, or as near to it as they come; ``distance_m`` is null without 3D boxes there."""

    looks: tuple[Look, Look]
    distance_m: float | None


class MergeLooks(BaseModel):
    """What there is to see of a merge. ``ego`` is the way of the car that recorded, empty without poses."""

    merge_id: int
    frame: PathFrame = Field(description="city: ways are over ground; ego: relative to the car, which has no poses.")
    sides: tuple[MergeSide, MergeSide]
    moments: list[Moment]
    strip: list[Look] = Field(description="Looks at all tracks of both identities in order of time.")
    ego: Way
    plot: MergePlot | None = Field(description="What the machine drew as its evidence; null where it drew nothing.")
