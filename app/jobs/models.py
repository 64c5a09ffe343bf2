"""Table of jobs."""

from datetime import datetime
from pathlib import Path

from sqlalchemy import ForeignKey, Index
from sqlalchemy.orm import Mapped, mapped_column

from app.db.base import Base, now


class JobRow(Base):
    """A piece of long work.

    ``worker`` is who has it, ``heartbeat_at`` its last sign of life, ``attempts`` how often the job was claimed.
    """

    __tablename__ = "job"
    __table_args__ = (
        Index(None, "state", "id"),
        {"sqlite_autoincrement": True},
    )

    id: Mapped[int] = mapped_column(primary_key=True)
    drive_id: Mapped[int] = mapped_column(ForeignKey("drive.id", ondelete="CASCADE"), index=True)
    kind: Mapped[str]
    state: Mapped[str]
    model_path: Mapped[str | None]
    stage: Mapped[str | None]
    done: Mapped[int] = mapped_column(default=0)
    total: Mapped[int] = mapped_column(default=0)
    message: Mapped[str | None]
    error: Mapped[str | None]
    attempts: Mapped[int] = mapped_column(default=0)
    worker: Mapped[str | None]
    heartbeat_at: Mapped[datetime | None]
    cancel_requested: Mapped[bool] = mapped_column(default=False)
    created_at: Mapped[datetime] = mapped_column(default=now)
    started_at: Mapped[datetime | None]
    finished_at: Mapped[datetime | None]

    @property
    def model(self) -> str | None:
        """Name of the model that a label job uses."""
        return Path(self.model_path).stem if self.model_path else None
