"""What a 3D view shows and where it gets it from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

from labeler.drive.types import Camera, Sweep


class Theme(StrEnum):
    """The page's colour scheme, which the 3D view follows."""

    DARK = "dark"
    LIGHT = "light"


@dataclass(frozen=True)
class SceneBox:
    """One 3D box in the ego frame at the sweep's time.

    ``center_m`` is x, y, z and ``size_m`` length, width, height, in metres; ``yaw_rad`` turns about z, 0 = length
    along x. ``identity_id`` is None for a box that no identity has. ``score`` in 0..1 is that of the label.
    """

    center_m: tuple[float, float, float]
    size_m: tuple[float, float, float]
    yaw_rad: float
    identity_id: int | None
    class_name: str
    score: float | None


@dataclass(frozen=True)
class SceneView:
    """Where the playhead stands, which identity is selected, and in which colours."""

    frame_index: int
    identity_id: int | None = None
    theme: Theme = Theme.DARK


class SceneSource(Protocol):
    """Content of one drive's 3D view. Called from the scene's own thread, one call at a time."""

    @property
    def cameras(self) -> tuple[Camera, ...]:
        """All cameras of the rig; those with a calibration are drawn."""
        ...

    @property
    def frame_count(self) -> int: ...

    def sweep(self, frame_index: int) -> Sweep | None:
        """The LiDAR points of a frame; None where the frame has no sweep. HindsightError when they can't be read."""
        ...

    def boxes(self, frame_index: int) -> Sequence[SceneBox]:
        """The 3D boxes of a frame."""
        ...
