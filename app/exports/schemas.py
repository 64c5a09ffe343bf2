"""What the page learns about exports."""

from enum import StrEnum

from pydantic import BaseModel, Field


class ExportFormat(StrEnum):
    COCO = "coco"


class ExportState(StrEnum):
    QUEUED = "queued"
    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"


class ExportRequest(BaseModel):
    """Labels below ``min_score`` stay out."""

    format: ExportFormat
    min_score: float = Field(default=0.0, ge=0.0, le=1.0)


class Export(BaseModel):
    """A dataset file, made by the worker; ``file_url`` is there when it is done."""

    id: int
    drive_id: int
    format: ExportFormat
    state: ExportState
    label_count: int | None
    size_bytes: int | None
    error: str | None
    job_id: int
    file_url: str | None
