"""The content of a stored drive's 3D view: sweeps from its files, boxes from the store."""

from dataclasses import dataclass
from pathlib import Path

from app.db.session import Store
from app.drives.service import open_recorded_drive, require_drive
from app.scene import repository
from app.scene.errors import NoLidar
from app.scene.types import SceneBox
from labeler.drive import Camera, Drive, Sweep


@dataclass(frozen=True, eq=False)
class StoredSource:
    """A :class:`app.scene.types.SceneSource` of a drive in the store."""

    store: Store
    drive_id: int
    drive: Drive

    @property
    def cameras(self) -> tuple[Camera, ...]:
        return self.drive.cameras

    @property
    def frame_count(self) -> int:
        return len(self.drive.frames)

    def sweep(self, frame_index: int) -> Sweep | None:
        """The points of a frame. DriveFileError when its sweep can't be read."""
        file = self.drive.frames[frame_index].sweep
        return None if file is None else self.drive.read_sweep(file)

    def boxes(self, frame_index: int) -> list[SceneBox]:
        with self.store.read() as session:
            return repository.boxes_of_frame(session, self.drive_id, frame_index)


def open_stored_source(store: Store, workspace: Path, drive_id: int) -> StoredSource:
    """The content of a drive. NotFound, NoLidar; UnusableDrive when its files can't be used any more."""
    with store.read() as session:
        row = require_drive(session, drive_id)
        if not row.has_lidar:
            raise NoLidar(f"Drive {row.name!r} has no LiDAR sweeps, so there is no 3D view of it.")
        path, scene = workspace / row.path, row.scene
    return StoredSource(store, drive_id, open_recorded_drive(path, scene=scene))
