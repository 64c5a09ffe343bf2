"""Table of exports."""

from sqlalchemy import ForeignKey
from sqlalchemy.orm import Mapped, mapped_column

from app.db.base import Base


class ExportRow(Base):
    """A dataset file of a drive; its state is that of its job. ``file_name`` lies in the workspace's exports folder."""

    __tablename__ = "export"
    __table_args__ = ({"sqlite_autoincrement": True},)

    id: Mapped[int] = mapped_column(primary_key=True)
    drive_id: Mapped[int] = mapped_column(ForeignKey("drive.id", ondelete="CASCADE"), index=True)
    job_id: Mapped[int] = mapped_column(ForeignKey("job.id", ondelete="CASCADE"), index=True)
    format: Mapped[str]
    min_score: Mapped[float]
    label_count: Mapped[int | None]
    size_bytes: Mapped[int | None]
    file_name: Mapped[str | None]
