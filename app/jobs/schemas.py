"""What the page learns about a job."""

from datetime import datetime
from enum import StrEnum

from pydantic import BaseModel, ConfigDict


class JobKind(StrEnum):
    LABEL = "label"
    EXPORT = "export"


class JobState(StrEnum):
    QUEUED = "queued"
    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"

    @property
    def is_final(self) -> bool:
        return self in (JobState.DONE, JobState.FAILED, JobState.CANCELLED)


class Job(BaseModel):
    """A piece of long work; ``done`` of ``total`` units of its current stage. ``model`` is the one that labels."""

    model_config = ConfigDict(from_attributes=True)

    id: int
    drive_id: int
    kind: JobKind
    state: JobState
    model: str | None
    stage: str | None
    done: int
    total: int
    message: str | None
    error: str | None
    created_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
