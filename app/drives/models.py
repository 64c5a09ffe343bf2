"""Tables of what was recorded."""

from datetime import datetime

from sqlalchemy import ForeignKey, ForeignKeyConstraint, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from app.db.base import Base, Nanoseconds, now


class DriveRow(Base):
    """A recorded drive. ``path`` is relative to the workspace for an uploaded one, else absolute.

    ``revision`` grows with every change to the drive's labels.
    """

    __tablename__ = "drive"
    __table_args__ = ({"sqlite_autoincrement": True},)

    id: Mapped[int] = mapped_column(primary_key=True)
    name: Mapped[str]
    format: Mapped[str]
    path: Mapped[str] = mapped_column(index=True)
    scene: Mapped[str | None]
    uploaded: Mapped[bool]
    frame_count: Mapped[int]
    start_ns: Mapped[int] = mapped_column(Nanoseconds)
    duration_ns: Mapped[int] = mapped_column(Nanoseconds)
    has_lidar: Mapped[bool]
    has_poses: Mapped[bool]
    is_simulated: Mapped[bool]
    warnings: Mapped[list[str]]
    revision: Mapped[int] = mapped_column(default=0)
    created_at: Mapped[datetime] = mapped_column(default=now)


class CameraRow(Base):
    """One camera of a drive; ``position`` is its place in the drive's order."""

    __tablename__ = "camera"
    __table_args__ = (UniqueConstraint("drive_id", "name"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    drive_id: Mapped[int] = mapped_column(ForeignKey("drive.id", ondelete="CASCADE"))
    position: Mapped[int]
    name: Mapped[str]
    width_px: Mapped[int]
    height_px: Mapped[int]
    has_calibration: Mapped[bool]


class FrameRow(Base):
    """One moment of a drive, and where the car was in the city frame, seen from above; NULL where that is not known."""

    __tablename__ = "frame"
    __table_args__ = ({"sqlite_with_rowid": False},)

    drive_id: Mapped[int] = mapped_column(ForeignKey("drive.id", ondelete="CASCADE"), primary_key=True)
    frame_index: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    timestamp_ns: Mapped[int] = mapped_column(Nanoseconds)
    ego_x_m: Mapped[float | None]
    ego_y_m: Mapped[float | None]
    ego_yaw_rad: Mapped[float | None]


class ImageRow(Base):
    """The image of one camera in one frame; ``path`` is relative to the drive's folder, or absolute outside of it."""

    __tablename__ = "image"
    __table_args__ = (
        ForeignKeyConstraint(["drive_id", "frame_index"], ["frame.drive_id", "frame.frame_index"], ondelete="CASCADE"),
        {"sqlite_with_rowid": False},
    )

    drive_id: Mapped[int] = mapped_column(primary_key=True)
    frame_index: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    camera_id: Mapped[int] = mapped_column(ForeignKey("camera.id", ondelete="CASCADE"), primary_key=True, index=True)
    timestamp_ns: Mapped[int] = mapped_column(Nanoseconds)
    path: Mapped[str]
