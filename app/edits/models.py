"""Table of what people's edits do to a labelling."""

from typing import Any

from sqlalchemy import ForeignKey, Index
from sqlalchemy.orm import Mapped, mapped_column

from app.db.base import Base


class EffectRow(Base):
    """What an edit does to one place of a labelling; derived from the edit's review.

    A place is a frame of a track as tracked (``tracked_id``), so that it means the same whatever else is edited. Of
    effects that contradict each other the one of the later review holds. ``made_track_id`` is the id of the track that
    begins with a cut. ``active`` is False while the edit is undone. See :class:`app.edits.types.EffectKind`.
    """

    __tablename__ = "effect"
    __table_args__ = (
        Index(None, "labelling_id", "tracked_id"),
        Index(None, "labelling_id", "kind"),
        {"sqlite_autoincrement": True},
    )

    id: Mapped[int] = mapped_column(primary_key=True)
    labelling_id: Mapped[int] = mapped_column(ForeignKey("labelling.id", ondelete="CASCADE"))
    review_id: Mapped[int] = mapped_column(ForeignKey("review.id", ondelete="CASCADE"), index=True)
    kind: Mapped[str]
    tracked_id: Mapped[int]
    frame_index: Mapped[int]
    other_tracked_id: Mapped[int | None]
    other_frame_index: Mapped[int | None]
    until_frame: Mapped[int | None]
    made_track_id: Mapped[int | None]
    value: Mapped[dict[str, Any]]
    active: Mapped[bool] = mapped_column(default=True)
