"""How a decision names the tracks that it is about."""

from enum import StrEnum
from typing import Any

from pydantic import BaseModel, Field


class ReviewAction(StrEnum):
    ACCEPT = "accept"
    REJECT = "reject"
    UNSURE = "unsure"
    UNDO = "undo"


class TrackAnchor(BaseModel):
    """One observation of a track: enough to find the same object in another labelling of the drive."""

    camera: str
    frame_index: int
    timestamp_ns: str
    box: tuple[float, float, float, float]


class MergeEvidence(BaseModel):
    """What the machine had said about the merge; kept with the decision."""

    score: float
    shared_frames: int
    agreeing_frames: int
    mean_distance_m: float | None
    mean_bev_iou: float | None
    reason: str
    best_frames: list[dict[str, float]]
    evidence: dict[str, Any] = Field(default_factory=dict)
