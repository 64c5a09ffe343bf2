"""The way of a track, seen from above: its 3D boxes in the city frame, or in the car's own where it has no poses.

Only the plane matters here, so the car's pose is taken as a turn about the vertical and a shift.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from app.db.session import Session
from app.motion import repository
from app.motion.repository import BoxOfTrack


class PathFrame(StrEnum):
    """What positions are relative to: the ground, or the moving car."""

    CITY = "city"
    EGO = "ego"


@dataclass(frozen=True, eq=False)
class BoxPath:
    """The 3D boxes of a track in order of time, N of them.

    ``frame_index`` (N,) int64, ``time_s`` (N,) seconds since the epoch of the drive's clock, ``xy_m`` (N, 2),
    ``yaw_rad`` (N,), ``size_m`` (N, 3) length, width, height; ``ego_distance_m`` (N,) from the car, seen from above.
    """

    frame_index: NDArray[np.int64]
    time_s: NDArray[np.float64]
    xy_m: NDArray[np.float64]
    yaw_rad: NDArray[np.float64]
    size_m: NDArray[np.float64]
    ego_distance_m: NDArray[np.float64]
    frame: PathFrame

    def __len__(self) -> int:
        return len(self.frame_index)

    def __getitem__(self, rows: NDArray[np.intp] | slice) -> "BoxPath":
        return BoxPath(
            self.frame_index[rows],
            self.time_s[rows],
            self.xy_m[rows],
            self.yaw_rad[rows],
            self.size_m[rows],
            self.ego_distance_m[rows],
            self.frame,
        )


def paths_of_tracks(session: Session, drive_id: int, labelling_id: int, track_ids: Sequence[int]) -> dict[int, BoxPath]:
    """The way of each track that has 3D boxes."""
    rows = repository.boxes_of_tracks(session, drive_id, labelling_id, track_ids)
    if not rows:
        return {}
    frame = PathFrame.EGO if any(row.ego_x_m is None for row in rows) else PathFrame.CITY
    path = _to_path(rows, frame)
    track_id = np.array([row.track_id for row in rows])
    starts = np.flatnonzero(np.r_[True, track_id[1:] != track_id[:-1]])
    stops = [*starts[1:].tolist(), len(rows)]
    return {int(track_id[start]): path[slice(start, stop)] for start, stop in zip(starts.tolist(), stops, strict=True)}


def _to_path(rows: Sequence[BoxOfTrack], frame: PathFrame) -> BoxPath:
    values = np.array(
        [
            (
                row.center_x_m,
                row.center_y_m,
                row.yaw_rad,
                row.length_m,
                row.width_m,
                row.height_m,
                row.ego_x_m or 0.0,
                row.ego_y_m or 0.0,
                row.ego_yaw_rad or 0.0,
            )
            for row in rows
        ]
    )
    x, y, yaw = values[:, 0], values[:, 1], values[:, 2]
    if frame is PathFrame.CITY:
        ego_x, ego_y, turn = values[:, 6], values[:, 7], values[:, 8]
        cos, sin = np.cos(turn), np.sin(turn)
        city_x, city_y = cos * x - sin * y + ego_x, sin * x + cos * y + ego_y
        xy, yaw = np.stack([city_x, city_y], axis=1), _wrapped(yaw + turn)
    else:
        xy = np.stack([x, y], axis=1)
    return BoxPath(
        frame_index=np.array([row.frame_index for row in rows], np.int64),
        time_s=np.array([row.timestamp_ns for row in rows], np.int64) / 1e9,
        xy_m=xy,
        yaw_rad=yaw,
        size_m=values[:, 3:6],
        ego_distance_m=np.hypot(x, y),
        frame=frame,
    )


def _wrapped(angle_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """Into -pi..pi."""
    return (angle_rad + math.pi) % (2 * math.pi) - math.pi
