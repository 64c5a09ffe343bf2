"""Table of merges."""

from typing import Any

from sqlalchemy import ForeignKey, Index
from sqlalchemy.orm import Mapped, mapped_column

from app.db.base import Base


class MergeRow(Base):
    """A claim that two tracks are one object, with its evidence.

    ``machine_state`` is what the labeler said. ``state`` is what holds: the person's word where there is one, else the
    machine's, but an acceptance by the machine that no longer fits is a proposal. ``evidence`` is the labeler's
    MergeEvidence as JSON, empty where the machine has measured nothing.

    The claim is about ``tracked_a`` in ``frame_a`` and ``tracked_b`` in ``frame_b``, tracks as tracked. ``track_a`` and
    ``track_b`` are the tracks that these frames belong to now; NULL where a person deleted them.
    """

    __tablename__ = "merge"
    __table_args__ = (
        Index(None, "labelling_id", "track_a", "track_b"),
        Index(None, "labelling_id", "track_b"),
        Index(None, "labelling_id", "decided_by", "state"),
        {"sqlite_autoincrement": True},
    )

    id: Mapped[int] = mapped_column(primary_key=True)
    labelling_id: Mapped[int] = mapped_column(ForeignKey("labelling.id", ondelete="CASCADE"))
    tracked_a: Mapped[int]
    tracked_b: Mapped[int]
    frame_a: Mapped[int]
    frame_b: Mapped[int]
    track_a: Mapped[int | None]
    track_b: Mapped[int | None]
    score: Mapped[float]
    machine_state: Mapped[str]
    state: Mapped[str]
    decided_by: Mapped[str]
    shared_frames: Mapped[int]
    agreeing_frames: Mapped[int]
    mean_distance_m: Mapped[float | None]
    mean_bev_iou: Mapped[float | None]
    reason: Mapped[str]
    best_frames: Mapped[list[dict[str, Any]]]
    evidence: Mapped[dict[str, Any]] = mapped_column(default=dict)

    @property
    def tracks(self) -> tuple[int, int]:
        """The two tracks of a merge of which neither was deleted."""
        assert self.track_a is not None
        assert self.track_b is not None
        return self.track_a, self.track_b
