"""The formats that can be opened, and the search for the one that a folder has."""

from __future__ import annotations

import os
from pathlib import Path

from labeler.drive.argoverse2 import ARGOVERSE2, has_annotations_only, open_annotated_log
from labeler.drive.errors import DriveError
from labeler.drive.format import DriveFormat
from labeler.drive.kitti import KITTI
from labeler.drive.listing import folders_in, some_of
from labeler.drive.nuscenes import NUSCENES
from labeler.drive.types import Drive

FORMATS: tuple[DriveFormat, ...] = (ARGOVERSE2, KITTI, NUSCENES)
"""All formats, in the order in which they are asked."""

_LEVELS_BELOW = 2


def open_drive(path: str | os.PathLike[str], *, scene: str | None = None) -> Drive:
    """Opens a recorded drive of any known format. No image is decoded, and no sweep is read.

    A folder that is no drive but holds exactly one, up to two levels down, opens that one. ``scene`` names a nuScenes
    scene or a KITTI sequence; it may be left out where there is only one. Raises DriveError when the folder holds no
    drive or several, or when the drive can't be used; what was skipped is told in ``Drive.warnings``."""
    root = _existing_folder(Path(path))
    found = _drives_in(root, _LEVELS_BELOW)
    if not found:
        raise DriveError(_nothing_known(root))
    if len(found) > 1:
        names = some_of([str(folder.relative_to(root)) for folder, _ in found], at_most=20)
        raise DriveError(f"{root} holds {len(found):,} drives: {names}. Name one of these folders.")
    folder, drive_format = found[0]
    return drive_format.open(folder, scene)


def open_truth(path: str | os.PathLike[str], *, scene: str | None = None) -> Drive:
    """Opens a drive for its truth alone: like :func:`open_drive`, but an Argoverse 2 log need not have any image.

    A frame of a log without images is a moment of its annotations, and has no images either."""
    root = _existing_folder(Path(path))
    if has_annotations_only(root):
        return open_annotated_log(root)
    return open_drive(root, scene=scene)


def _existing_folder(path: Path) -> Path:
    try:
        path = path.expanduser().resolve()
        if path.is_dir():
            return path
        is_there = path.exists()
    except (OSError, RuntimeError, ValueError) as error:
        raise DriveError(f"{path} can't be opened as a drive: {error}.") from error
    if is_there:
        raise DriveError(f"{path} is a file, but a drive is a folder. If it is an archive, unpack it first.")
    raise DriveError(f"{path} does not exist.")


def _drives_in(folder: Path, levels_below: int) -> list[tuple[Path, DriveFormat]]:
    try:
        for drive_format in FORMATS:
            if drive_format.matches(folder):
                return [(folder, drive_format)]
        children = folders_in(folder) if levels_below else []
    except (OSError, DriveError):
        return []  # what can't be read can't be searched; of the outermost folder, _nothing_known says so
    return [drive for child in children for drive in _drives_in(child, levels_below - 1)]


def _nothing_known(root: Path) -> str:
    looked_for = "; ".join(f"{drive_format.name}: {drive_format.looked_for}" for drive_format in FORMATS)
    try:
        there = sorted(child.name + ("/" if child.is_dir() else "") for child in root.iterdir())
    except OSError as error:
        return f"{root} can't be read: {error.strerror}. Check its permissions."
    lies_there = f"There lies {some_of(there, at_most=10)}" if there else "The folder is empty"
    return f"{root} is no drive of a known format. Looked for {looked_for}. {lies_there}."
