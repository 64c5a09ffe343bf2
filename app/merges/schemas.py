"""What the page learns about merges."""

from enum import StrEnum

from pydantic import BaseModel, Field

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


class Merge(BaseModel):
    """A claim that two tracks are one object, with its evidence."""

    id: int
    track_a: int
    track_b: int
    camera_a: str
    camera_b: str
    score: float
    probability: float = Field(description="How likely it is that both tracks are one object, from 0 to 1.")
    state: MergeState
    decided_by: DecidedBy
    shared_frames: int
    agreeing_frames: int
    mean_distance_m: float
    mean_bev_iou: float
    reason: str
    best_frames: list[MergeFrame]
    label_count: int = Field(description="How many labels accepting or undoing it changes.")
    priority: float = Field(
        description="Impact times uncertainty: label_count times the entropy of the probability in bits. The queue "
        "goes from high to low."
    )
    identity_a: int
    identity_b: int


class MergeChange(BaseModel):
    """What a decision changed; ``identity_ids`` are the identities that its tracks are in afterwards.

    ``merges`` are the merges of all tracks of these identities, as they are now, this one among them."""

    merge: Merge
    merges: list[Merge]
    changed_label_count: int
    identity_ids: list[int]
    revision: int


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
