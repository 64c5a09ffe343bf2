"""Tables of what the labeler found.

A labelling is one result of the pipeline for a drive. Its rows are written in short transactions while readers still
see the one before; then ``current`` moves over. Track and identity ids are the labeler's numbers in the drive.
"""

from datetime import datetime
from typing import Any

from sqlalchemy import ForeignKey, ForeignKeyConstraint, Index
from sqlalchemy.orm import Mapped, mapped_column

from app.db.base import Base, now


class LabellingRow(Base):
    """One result of the pipeline; ``key`` names its inputs and settings.

    ``propagation`` are the settings by which labels were given, NULL where that was not kept; then the labeler's first
    rule holds, the paper's. ``since_revision`` is the drive's revision with which readers began to see it.
    """

    __tablename__ = "labelling"
    __table_args__ = ({"sqlite_autoincrement": True},)

    id: Mapped[int] = mapped_column(primary_key=True)
    drive_id: Mapped[int] = mapped_column(ForeignKey("drive.id", ondelete="CASCADE"), index=True)
    key: Mapped[str]
    model_name: Mapped[str]
    class_names: Mapped[list[str]]
    summary: Mapped[dict[str, Any]]
    warnings: Mapped[list[str]]
    propagation: Mapped[dict[str, Any] | None]
    observation_count: Mapped[int] = mapped_column(default=0)
    current: Mapped[bool] = mapped_column(default=False)
    since_revision: Mapped[int] = mapped_column(default=0)
    created_at: Mapped[datetime] = mapped_column(default=now)


class TrackRow(Base):
    """One object in one camera: a track as the machine made it, or a piece of one that a person split.

    ``tracked_id`` names the track as tracked, and never changes; the first piece of a track keeps its id.
    ``best_score`` is NULL where no observation has a score.
    """

    __tablename__ = "track"
    __table_args__ = (
        Index(None, "labelling_id", "identity_id"),
        Index(None, "labelling_id", "tracked_id"),
        {"sqlite_with_rowid": False},
    )

    labelling_id: Mapped[int] = mapped_column(ForeignKey("labelling.id", ondelete="CASCADE"), primary_key=True)
    track_id: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    tracked_id: Mapped[int]
    camera_id: Mapped[int] = mapped_column(ForeignKey("camera.id", ondelete="CASCADE"), index=True)
    first_frame: Mapped[int]
    last_frame: Mapped[int]
    observation_count: Mapped[int]
    best_score: Mapped[float | None]
    best_frame: Mapped[int]
    class_id: Mapped[int]
    identity_id: Mapped[int]


class ObservationRow(Base):
    """A box in one image, as tracked, or ``drawn`` by a person.

    ``tracked_id`` is the track as tracked that it was made for, ``track_id`` the track that it belongs to now, NULL
    where a person deleted it or drew another in its place. ``score`` is NULL where the tracker filled the box in, and
    where a person drew it; ``filled`` tells that the box lies between known ones. ``trust`` is how likely the box shows
    its track's object, NULL where nobody judged.
    """

    __tablename__ = "observation"
    __table_args__ = (
        ForeignKeyConstraint(
            ["labelling_id", "track_id"], ["track.labelling_id", "track.track_id"], ondelete="CASCADE"
        ),
        Index(None, "labelling_id", "frame_index"),
        Index(None, "labelling_id", "track_id", "frame_index", unique=True),
        Index(None, "labelling_id", "tracked_id", "frame_index"),
    )

    id: Mapped[int] = mapped_column(primary_key=True)
    labelling_id: Mapped[int]
    tracked_id: Mapped[int]
    track_id: Mapped[int | None]
    frame_index: Mapped[int]
    x1_px: Mapped[float]
    y1_px: Mapped[float]
    x2_px: Mapped[float]
    y2_px: Mapped[float]
    score: Mapped[float | None]
    class_id: Mapped[int]
    filled: Mapped[bool]
    drawn: Mapped[bool] = mapped_column(default=False)
    trust: Mapped[float | None]


class LabelRow(Base):
    """The label of one observation; derived. The donor is named by its track and frame.

    ``score`` is NULL where neither the observation nor any other of its identity has one. What a person said (class, or
    the box itself) has the source ``human``, the score 1, and itself as the donor. ``withheld`` is why an observation
    did not get its identity's label, NULL where it did; ``probability`` is how likely the label is right, NULL where
    that is not known, or a person's word.
    """

    __tablename__ = "label"
    __table_args__ = (
        ForeignKeyConstraint(
            ["labelling_id", "track_id"], ["track.labelling_id", "track.track_id"], ondelete="CASCADE"
        ),
        {"sqlite_with_rowid": False},
    )

    labelling_id: Mapped[int] = mapped_column(primary_key=True)
    track_id: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    frame_index: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    class_id: Mapped[int]
    score: Mapped[float | None]
    source: Mapped[str]
    donor_track_id: Mapped[int]
    donor_frame_index: Mapped[int]
    withheld: Mapped[str | None]
    probability: Mapped[float | None]


class Box3DRow(Base):
    """A 3D box made for one camera direction, in the ego frame [m, rad].

    ``tracked_id`` is the track as tracked that has it, NULL where none has. ``track_id`` is the track now; it is NULL
    beside a ``tracked_id`` where a person deleted the observation.
    """

    __tablename__ = "box3d"
    __table_args__ = (
        Index(None, "labelling_id", "track_id"),
        {"sqlite_with_rowid": False},
    )

    labelling_id: Mapped[int] = mapped_column(ForeignKey("labelling.id", ondelete="CASCADE"), primary_key=True)
    frame_index: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    camera_id: Mapped[int] = mapped_column(ForeignKey("camera.id", ondelete="CASCADE"), primary_key=True, index=True)
    row: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    tracked_id: Mapped[int | None]
    track_id: Mapped[int | None]
    center_x_m: Mapped[float]
    center_y_m: Mapped[float]
    center_z_m: Mapped[float]
    length_m: Mapped[float]
    width_m: Mapped[float]
    height_m: Mapped[float]
    yaw_rad: Mapped[float]
    score: Mapped[float]
    class_id: Mapped[int]
    point_count: Mapped[int]
