"""SQL about what was recorded."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from sqlalchemy import bindparam, delete, insert, select, update
from sqlalchemy.orm import Session

from app.db.rows import plain_rows
from app.drives.models import CameraRow, DriveRow, FrameRow, ImageRow

BATCH = 5_000

_TIMES_OF_FRAMES = (
    select(FrameRow.timestamp_ns).where(FrameRow.drive_id == bindparam("drive_id")).order_by(FrameRow.frame_index)
)
# Not by pairs of both: SQLite finds these by no index.
_TIMES_OF_IMAGES = select(ImageRow.frame_index, ImageRow.camera_id, ImageRow.timestamp_ns).where(
    ImageRow.drive_id == bindparam("drive_id"),
    ImageRow.frame_index.in_(bindparam("frames", expanding=True)),
    ImageRow.camera_id.in_(bindparam("camera_ids", expanding=True)),
)


class StoredImage(NamedTuple):
    """Where an image lies; ``image_path`` is relative to the drive's folder, or absolute."""

    drive_path: str
    image_path: str


class ImageInfo(NamedTuple):
    """An image with what a dataset says about it."""

    frame_index: int
    camera_id: int
    timestamp_ns: int
    path: str


def insert_drive(session: Session, drive: DriveRow, cameras: Iterable[CameraRow]) -> None:
    """Add a drive and its cameras; gives them their ids."""
    session.add(drive)
    session.flush()
    for camera in cameras:
        camera.drive_id = drive.id
        session.add(camera)
    session.flush()


def insert_frames(session: Session, frames: Sequence[Mapping[str, Any]], images: Sequence[Mapping[str, Any]]) -> None:
    """Add frames and then their images, as rows of columns."""
    for table, rows in ((FrameRow, frames), (ImageRow, images)):
        for start in range(0, len(rows), BATCH):
            session.execute(insert(table), rows[start : start + BATCH])


def find(session: Session, drive_id: int) -> DriveRow | None:
    return session.get(DriveRow, drive_id)


def find_by_path(session: Session, path: str, scene: str | None) -> DriveRow | None:
    query = select(DriveRow).where(DriveRow.path == path, DriveRow.scene.is_not_distinct_from(scene))
    return session.scalars(query).first()


def list_newest_first(session: Session) -> Sequence[DriveRow]:
    return session.scalars(select(DriveRow).order_by(DriveRow.id.desc())).all()


def cameras_of(session: Session, drive_ids: Sequence[int]) -> dict[int, list[CameraRow]]:
    """The cameras of each drive, in the drive's order."""
    cameras: dict[int, list[CameraRow]] = {drive_id: [] for drive_id in drive_ids}
    query = select(CameraRow).where(CameraRow.drive_id.in_(drive_ids)).order_by(CameraRow.position)
    for camera in session.scalars(query):
        cameras[camera.drive_id].append(camera)
    return cameras


def frame_times_ns(session: Session, drive_id: int) -> Sequence[int]:
    """One time per frame, in order."""
    return [time_ns for (time_ns,) in plain_rows(session, _TIMES_OF_FRAMES, {"drive_id": drive_id})]


def image_times_ns(session: Session, drive_id: int, images: Collection[tuple[int, int]]) -> list[int]:
    """When a few images were taken, which are named by frame and camera, and must be there; in their order."""
    frames, camera_ids = zip(*images, strict=True)
    rows = session.execute(_TIMES_OF_IMAGES, {"drive_id": drive_id, "frames": frames, "camera_ids": camera_ids})
    found = {(frame_index, camera_id): time_ns for frame_index, camera_id, time_ns in rows}
    return [found[image] for image in images]


def find_image(session: Session, drive_id: int, frame_index: int, camera: str) -> StoredImage | None:
    query = (
        select(DriveRow.path, ImageRow.path)
        .join(CameraRow, CameraRow.id == ImageRow.camera_id)
        .join(DriveRow, DriveRow.id == ImageRow.drive_id)
        .where(ImageRow.drive_id == drive_id, ImageRow.frame_index == frame_index, CameraRow.name == camera)
    )
    row = session.execute(query).one_or_none()
    return StoredImage(*row) if row else None


def images_between(session: Session, drive_id: int, start: int, stop: int) -> list[ImageInfo]:
    """Images of the frames ``start <= frame_index < stop``, by frame and camera."""
    query = (
        select(ImageRow.frame_index, ImageRow.camera_id, ImageRow.timestamp_ns, ImageRow.path)
        .where(ImageRow.drive_id == drive_id, ImageRow.frame_index >= start, ImageRow.frame_index < stop)
        .order_by(ImageRow.frame_index, ImageRow.camera_id)
    )
    return [ImageInfo(*row) for row in session.execute(query)]


def raise_revision(session: Session, drive_id: int) -> int:
    """Count a change to the drive's labels; the new revision."""
    return session.scalars(
        update(DriveRow)
        .where(DriveRow.id == drive_id)
        .values(revision=DriveRow.revision + 1)
        .returning(DriveRow.revision),
        execution_options={"synchronize_session": False},
    ).one()


def delete_drive(session: Session, drive_id: int) -> None:
    """Remove a drive and all that hangs on it."""
    session.execute(delete(DriveRow).where(DriveRow.id == drive_id))
