"""Table of identities."""

from sqlalchemy import ForeignKey
from sqlalchemy.orm import Mapped, mapped_column

from app.db.base import Base


class IdentityRow(Base):
    """One object: a connected component of tracks, with the label of its best observation; derived.

    ``class_by_person`` tells that a person set the class. ``mark`` is what a person says of the object: ``reviewed``,
    ``ignored`` (not exported) or NULL. ``score`` is NULL where no observation has one.
    """

    __tablename__ = "identity"
    __table_args__ = ({"sqlite_with_rowid": False},)

    labelling_id: Mapped[int] = mapped_column(ForeignKey("labelling.id", ondelete="CASCADE"), primary_key=True)
    identity_id: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    class_id: Mapped[int]
    score: Mapped[float | None]
    donor_track_id: Mapped[int]
    donor_frame_index: Mapped[int]
    first_frame: Mapped[int]
    last_frame: Mapped[int]
    observation_count: Mapped[int]
    propagated_count: Mapped[int]
    class_by_person: Mapped[bool] = mapped_column(default=False)
    mark: Mapped[str | None]
    comment_count: Mapped[int] = mapped_column(default=0)
