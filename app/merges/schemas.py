"""What the page learns about merges."""

from enum import StrEnum

from pydantic import BaseModel, Field


class MergeState(StrEnum):
    PROPOSED = "proposed"
    ACCEPTED = "accepted"
    REJECTED = "rejected"


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
    state: MergeState
    decided_by: DecidedBy
    shared_frames: int
    agreeing_frames: int
    mean_distance_m: float
    mean_bev_iou: float
    reason: str
    best_frames: list[MergeFrame]
    label_count: int = Field(description="How many labels accepting or undoing it changes.")
    identity_a: int
    identity_b: int


class MergeChange(BaseModel):
    """What a decision changed; ``identity_ids`` are the identities that its tracks are in afterwards."""

    merge: Merge
    changed_label_count: int
    identity_ids: list[int]
    revision: int
