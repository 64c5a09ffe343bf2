"""What was recorded: frozen types that every later step reads.

Coordinates: the ego frame has x forward, y left, z up, in metres. The camera frame has x right, y down, z forward.
Pixels count from the upper left corner of the image. ``a_SE3_b`` is a 4x4 matrix that maps b's coordinates to a's. Time
is integer nanoseconds.

A :class:`Drive` holds names of files, never their content, so that its size stays small however long the recording is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from labeler.geometry.se3 import interpolate_se3


@dataclass(frozen=True, eq=False)
class Calibration:
    """Pinhole camera without distortion (the supported formats store rectified images).

    ``intrinsics`` is (3, 3) float64 in pixels, ``ego_SE3_camera`` is (4, 4) float64 in metres."""

    intrinsics: NDArray[np.float64]
    ego_SE3_camera: NDArray[np.float64]

    def __post_init__(self) -> None:
        _require_shape("intrinsics", self.intrinsics, (3, 3))
        _require_shape("ego_SE3_camera", self.ego_SE3_camera, (4, 4))


@dataclass(frozen=True, eq=False)
class Camera:
    """One camera of the rig. Without a calibration it is labelled in 2D only and takes no part in merges."""

    name: str
    width_px: int
    height_px: int
    calibration: Calibration | None


@dataclass(frozen=True)
class ImageFile:
    """One recorded image, by name."""

    camera: str
    timestamp_ns: int
    path: Path


@dataclass(frozen=True)
class SweepFile:
    """One recorded LiDAR sweep, by name."""

    timestamp_ns: int
    path: Path


@dataclass(frozen=True)
class Frame:
    """The sensor readings nearest to one moment: at most one image per camera and at most one sweep.

    ``index`` counts from 0 without gaps; ``timestamp_ns`` is that of the sweep, or of the reference camera where there
    is none.
    """

    index: int
    timestamp_ns: int
    images: Mapping[str, ImageFile]
    sweep: SweepFile | None


@dataclass(frozen=True, eq=False)
class Sweep:
    """LiDAR points of one sweep: ``xyz_m`` (N, 3) float32 in the ego frame, ``intensity`` (N,) float32 as recorded.

    ``offset_ns`` (N,) int32 is when each point was measured, less the sweep's time; None where that is not recorded.
    The ego car's own motion is taken out of the points already; what moves besides lies where it was then."""

    timestamp_ns: int
    xyz_m: NDArray[np.float32]
    intensity: NDArray[np.float32]
    offset_ns: NDArray[np.int32] | None = None

    def __post_init__(self) -> None:
        points = len(self.xyz_m)
        _require_shape("xyz_m", self.xyz_m, (points, 3))
        _require_shape("intensity", self.intensity, (points,))
        if self.offset_ns is not None:
            _require_shape("offset_ns", self.offset_ns, (points,))


@dataclass(frozen=True, eq=False)
class Poses:
    """Where the car was: ``timestamp_ns`` (N,) int64 increasing, ``city_SE3_ego`` (N, 4, 4) float64 in metres."""

    timestamp_ns: NDArray[np.int64]
    city_SE3_ego: NDArray[np.float64]

    def __post_init__(self) -> None:
        count = len(self.timestamp_ns)
        _require_shape("timestamp_ns", self.timestamp_ns, (count,))
        _require_shape("city_SE3_ego", self.city_SE3_ego, (count, 4, 4))
        if count and np.any(np.diff(self.timestamp_ns) <= 0):
            raise ValueError("Poses.timestamp_ns must be strictly increasing")

    def at(self, timestamp_ns: int) -> NDArray[np.float64]:
        """``city_SE3_ego`` at a moment, (4, 4): interpolated; before the first the first, after the last the last."""
        return self.at_each(np.array([timestamp_ns], np.int64))[0]

    def at_each(self, timestamp_ns: NDArray[np.int64]) -> NDArray[np.float64]:
        """Those at several moments (N,), (N, 4, 4)."""
        return interpolate_se3(self.timestamp_ns, self.city_SE3_ego, timestamp_ns)


@dataclass(frozen=True, eq=False)
class TruthBoxes2D:
    """True boxes in images, a row each. ``xyxy_px`` (N, 4) float32 is the box of the whole object.

    ``frame_index`` (N,) int32; ``camera``, ``track_uuid`` and ``category`` are tuples of N strings (category as the
    format names it). Where recorded: ``visible_xyxy_px`` (N, 4) float32 is the box of the visible part,
    ``visible_share`` (N,) float32 how much of the object is visible, from 0 to 1, ``visible_pixels`` (N,) int32 how
    many pixels show it, and ``distance_m`` (N,) float32 the distance.
    """

    frame_index: NDArray[np.int32]
    camera: tuple[str, ...]
    track_uuid: tuple[str, ...]
    category: tuple[str, ...]
    xyxy_px: NDArray[np.float32]
    visible_xyxy_px: NDArray[np.float32] | None = None
    distance_m: NDArray[np.float32] | None = None
    visible_share: NDArray[np.float32] | None = None
    visible_pixels: NDArray[np.int32] | None = None


@dataclass(frozen=True, eq=False)
class TruthBoxes3D:
    """True 3D boxes, a row each, in the ego frame at the frame's time.

    ``frame_index`` (N,) int32, ``center_m`` (N, 3), ``size_m`` (N, 3) as length, width, height, ``yaw_rad`` (N,), all
    float64. Where recorded: ``num_points`` (N,) int64 LiDAR points inside of the box.
    """

    frame_index: NDArray[np.int32]
    track_uuid: tuple[str, ...]
    category: tuple[str, ...]
    center_m: NDArray[np.float64]
    size_m: NDArray[np.float64]
    yaw_rad: NDArray[np.float64]
    num_points: NDArray[np.int64] | None = None


@dataclass(frozen=True, eq=False)
class Truth:
    """What is known for sure about a drive: either table may be missing."""

    boxes_2d: TruthBoxes2D | None
    boxes_3d: TruthBoxes3D | None


class SweepReader(Protocol):
    """Reads one sweep file of a format into the ego frame; picklable, so that worker processes can have it.

    Raises :class:`labeler.drive.errors.DriveFileError` when the file can't be used."""

    def __call__(self, file: SweepFile) -> Sweep: ...


class TruthReader(Protocol):
    """Reads the truth that lies beside a drive, or returns None where there is none."""

    def __call__(self, frames: tuple[Frame, ...]) -> Truth | None: ...


@dataclass(frozen=True, eq=False)
class Drive:
    """A recorded drive: cameras, frames in order of time, poses where recorded, and what was skipped on opening."""

    name: str
    format: str
    root: Path
    cameras: tuple[Camera, ...]
    frames: tuple[Frame, ...]
    poses: Poses | None
    read_sweep: SweepReader
    read_truth: TruthReader
    warnings: tuple[str, ...] = field(default=())

    @property
    def has_lidar(self) -> bool:
        return any(frame.sweep is not None for frame in self.frames)

    def camera(self, name: str) -> Camera:
        """The camera of that name; KeyError when the drive has none."""
        for camera in self.cameras:
            if camera.name == name:
                return camera
        raise KeyError(name)


def _require_shape(name: str, array: NDArray[np.generic], shape: tuple[int, ...]) -> None:
    if array.shape != shape:
        raise ValueError(f"{name} must have shape {shape}, got {array.shape}")
