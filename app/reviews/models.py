"""Table of people's decisions."""

from datetime import datetime
from typing import Any

from sqlalchemy import ForeignKey
from sqlalchemy.orm import Mapped, mapped_column

from app.db.base import Base, now


class ReviewRow(Base):
    """A decision of a person; rows are only ever added.

    A decision about a merge names its two tracks by anchors (camera, frame_index, timestamp_ns, box), so that it can be
    found again in another labelling of the drive. ``subject_id`` is the first decision about the same two objects; the
    latest one of a subject that is not undone holds. ``merge_id`` is the merge of the current labelling that the
    subject stands for, NULL where none does.

    Other decisions say in ``payload`` what they do, and where; these columns are empty then. A decision that takes
    another one back, or makes it again, names it in ``target_id``; ``undone`` tells of the named one what the latest of
    these made of it. ``revision`` is the drive's with this decision.
    """

    __tablename__ = "review"
    __table_args__ = ({"sqlite_autoincrement": True},)

    id: Mapped[int] = mapped_column(primary_key=True)
    drive_id: Mapped[int] = mapped_column(ForeignKey("drive.id", ondelete="CASCADE"), index=True)
    merge_id: Mapped[int | None] = mapped_column(ForeignKey("merge.id", ondelete="SET NULL"), index=True)
    subject_id: Mapped[int | None] = mapped_column(ForeignKey("review.id", ondelete="CASCADE"), index=True)
    action: Mapped[str]
    reviewer: Mapped[str]
    created_at: Mapped[datetime] = mapped_column(default=now)
    anchor_a: Mapped[dict[str, Any]]
    anchor_b: Mapped[dict[str, Any]]
    evidence: Mapped[dict[str, Any]]
    payload: Mapped[dict[str, Any]]
    target_id: Mapped[int | None] = mapped_column(ForeignKey("review.id", ondelete="CASCADE"), index=True)
    undone: Mapped[bool] = mapped_column(default=False)
    revision: Mapped[int] = mapped_column(default=0)
