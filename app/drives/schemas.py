"""What the page learns about drives."""

from datetime import datetime
from enum import StrEnum
from typing import Any

from pydantic import BaseModel, Field

from app.jobs.schemas import Job
from labeler.models import Origin


class DriveState(StrEnum):
    NEW = "new"
    QUEUED = "queued"
    LABELLING = "labelling"
    READY = "ready"
    FAILED = "failed"


class Drive(BaseModel):
    """A recorded drive in a list; ``job`` is its latest label job."""

    id: int
    name: str
    format: str
    state: DriveState
    frame_count: int
    camera_names: list[str]
    duration_ms: float
    has_lidar: bool
    has_poses: bool
    is_simulated: bool
    model: str | None = Field(description="Name of the model that made its labels.")
    notice: str | None = Field(description="What a person must know before they trust that model on this drive.")
    identity_count: int
    track_count: int
    observation_count: int
    proposed_merge_count: int
    uploaded: bool
    error: str | None
    created_at: datetime
    job: Job | None


class Camera(BaseModel):
    name: str
    width_px: int
    height_px: int
    has_calibration: bool


class DriveDetail(Drive):
    """One drive in full. ``revision`` grows with every change to its labels."""

    cameras: list[Camera]
    frame_times_ms: list[float] = Field(description="One time per frame, since the drive's start.")
    warnings: list[str]
    class_names: list[str]
    revision: int
    summary: dict[str, Any] | None = Field(description="What the pipeline reported.")


class DriveRegistration(BaseModel):
    """A folder on the server's own disk; ``scene`` chooses one where the folder holds several."""

    path: str = Field(min_length=1)
    scene: str | None = None


class LabelRequest(BaseModel):
    """``model`` is what a Model is ``named`` by, or a file on the server's disk; without it, the default is taken."""

    model: str | None = None


class Model(BaseModel):
    """A detector that drives can be labelled with."""

    name: str
    named: str = Field(description="What a label request calls it.")
    origin: Origin
    default: bool = Field(description="Whether it is taken when none is named.")
    notice: str | None = Field(description="What a person must know before they use it on a drive not simulated.")
