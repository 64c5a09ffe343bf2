"""What the page learns of an audit: what ``hindsight audit --json`` prints, typed."""

from datetime import datetime

from pydantic import BaseModel, Field


class Agreement(BaseModel):
    """How many agree of how many, their share, and the interval that holds the true share in 95 of 100 cases."""

    agree: int
    of: int
    share: float | None
    low: float | None
    high: float | None


class AuditBin(BaseModel):
    """Hidden observations whose value lies from start to stop; stop is null without an end."""

    start: float
    stop: float | None
    box: Agreement = Field(description="A box is where the hidden one was.")
    label: Agreement = Field(description="It has the hidden one's class, of those that are there.")


class Audit(BaseModel):
    """What became of confident observations that were hidden from tracking, merging and propagation."""

    drive: str
    share: float
    confidence: float
    seed: int
    iou: float
    confident: int = Field(description="Observations that could have been hidden.")
    hidden: int
    box: Agreement
    label: Agreement
    by_distance: list[AuditBin] = Field(description="Bins in metres; empty where distances are not known.")
    by_height: list[AuditBin] = Field(description="Bins of the box's height, in pixels.")
    created_at: datetime
