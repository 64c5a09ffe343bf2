"""What the LiDAR step says: 3D boxes of what one camera sees, and where each detection stands.

Both are in the ego frame at the frame's time. Where a sweep tells when each point was measured, ``offset_s`` says when
the object was where it is said to be: it may have moved on until the frame's time.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray


class BoxSource(IntEnum):
    """How a 3D box was made."""

    CLUSTER = 0
    """Fitted to LiDAR points that hang together, filled up to the usual size of its class."""
    PILLARS = 1
    """Found by a pillar network on painted points."""
    TRACK = 2
    """Steadied over the boxes of its track."""


class PositionSource(IntEnum):
    """What a position was made from."""

    BOX = 0
    """The centre of the detection's 3D box."""
    POINTS = 1
    """A few LiDAR points, too few for a box."""
    HEIGHT = 2
    """The height of the detection in the image, and the usual height of its class."""


@dataclass(frozen=True, eq=False)
class Boxes3D:
    """3D boxes made for one camera direction in one frame, a row each, in the ego frame at the frame's time.

    ``center_m`` (N, 3) float32, ``size_m`` (N, 3) float32 as length, width, height, ``yaw_rad`` (N,) float32 about z,
    ``score`` (N,) float32 in 0..1, ``class_id`` (N,) int16, ``num_points`` (N,) int32 LiDAR points that the box was
    fitted to, ``detection_index`` (N,) int32: the row of the camera's Detections in that frame that the box belongs to.

    ``source`` (N,) int8 is a :class:`BoxSource`. ``center_std_m`` (N, 2) float32 is the standard deviation of the
    centre along the box's length and across it, ``yaw_std_rad`` (N,) float32 that of the yaw; which end is the front is
    known of TRACK and PILLARS boxes only. ``seen_m`` (N, 4) float32 is how far the points reach from the centre in the
    box's own axes: lowest along and across, highest along and across; what lies beyond them is a guess from the class.
    ``offset_s`` (N,) float32 is the mean time of the box's points less the frame's time.
    """

    center_m: NDArray[np.float32]
    size_m: NDArray[np.float32]
    yaw_rad: NDArray[np.float32]
    score: NDArray[np.float32]
    class_id: NDArray[np.int16]
    num_points: NDArray[np.int32]
    detection_index: NDArray[np.int32]
    source: NDArray[np.int8]
    center_std_m: NDArray[np.float32]
    yaw_std_rad: NDArray[np.float32]
    seen_m: NDArray[np.float32]
    offset_s: NDArray[np.float32]

    def __post_init__(self) -> None:
        _require_rows(self, {"center_m": 3, "size_m": 3, "center_std_m": 2, "seen_m": 4})

    def __len__(self) -> int:
        return len(self.score)

    def __getitem__(self, rows: NDArray[np.bool_] | NDArray[np.intp] | slice) -> Boxes3D:
        return Boxes3D(**{name: column[rows] for name, column in _columns(self).items()})

    @staticmethod
    def empty() -> Boxes3D:
        return Boxes3D(
            center_m=np.zeros((0, 3), np.float32),
            size_m=np.zeros((0, 3), np.float32),
            yaw_rad=np.zeros(0, np.float32),
            score=np.zeros(0, np.float32),
            class_id=np.zeros(0, np.int16),
            num_points=np.zeros(0, np.int32),
            detection_index=np.zeros(0, np.int32),
            source=np.zeros(0, np.int8),
            center_std_m=np.zeros((0, 2), np.float32),
            yaw_std_rad=np.zeros(0, np.float32),
            seen_m=np.zeros((0, 4), np.float32),
            offset_s=np.zeros(0, np.float32),
        )

    @staticmethod
    def concatenate(parts: Sequence[Boxes3D]) -> Boxes3D:
        """The rows of all parts, one after the other."""
        columns = [_columns(part) for part in (Boxes3D.empty(), *parts)]
        return Boxes3D(**{name: np.concatenate([part[name] for part in columns]) for name in columns[0]})


@dataclass(frozen=True, eq=False)
class Positions3D:
    """Where the detections of one camera in one frame stand, a row each, in the ego frame at the frame's time.

    ``detection_index`` (N,) int32 is the row of the camera's Detections in that frame, ``position_m`` (N, 3) float32
    the middle of the object, ``position_cov_m2`` (N, 3) float32 the covariance of its x and y as xx, xy, yy: long along
    the line of sight, short across it. ``position_source`` (N,) int8 is a :class:`PositionSource`,
    ``position_offset_s`` (N,) float32 the time of the position less the frame's.
    """

    detection_index: NDArray[np.int32]
    position_m: NDArray[np.float32]
    position_cov_m2: NDArray[np.float32]
    position_source: NDArray[np.int8]
    position_offset_s: NDArray[np.float32]

    def __post_init__(self) -> None:
        _require_rows(self, {"position_m": 3, "position_cov_m2": 3})

    def __len__(self) -> int:
        return len(self.detection_index)

    def __getitem__(self, rows: NDArray[np.bool_] | NDArray[np.intp] | slice) -> Positions3D:
        return Positions3D(**{name: column[rows] for name, column in _columns(self).items()})

    def covariances(self) -> NDArray[np.float64]:
        """(N, 2, 2) covariance of x and y in square metres."""
        return self.position_cov_m2[:, [[0, 1], [1, 2]]].astype(np.float64)

    @staticmethod
    def empty() -> Positions3D:
        return Positions3D(
            np.zeros(0, np.int32),
            np.zeros((0, 3), np.float32),
            np.zeros((0, 3), np.float32),
            np.zeros(0, np.int8),
            np.zeros(0, np.float32),
        )


def _columns(rows: Boxes3D | Positions3D) -> Mapping[str, NDArray[Any]]:
    return {field.name: getattr(rows, field.name) for field in fields(rows)}


def _require_rows(rows: Boxes3D | Positions3D, widths: Mapping[str, int]) -> None:
    """ValueError unless all fields have as many rows as ``detection_index``, and those in ``widths`` such columns."""
    count = len(rows.detection_index)
    for name, column in _columns(rows).items():
        shape = (count, widths[name]) if name in widths else (count,)
        if column.shape != shape:
            raise ValueError(f"{type(rows).__name__}.{name} must have shape {shape}, got {column.shape}")
