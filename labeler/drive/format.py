"""What a reader of one drive format offers to the registry."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from labeler.drive.types import Drive


@dataclass(frozen=True)
class DriveFormat:
    """One recorded layout. ``looked_for`` tells a user in words by what ``matches`` knows a folder of this format.

    ``matches`` only asks whether a few names exist. ``open`` takes the folder and the name of a scene, or None; it
    raises :class:`labeler.drive.errors.DriveError` when the drive can't be used."""

    name: str
    looked_for: str
    matches: Callable[[Path], bool]
    open: Callable[[Path, str | None], Drive]
