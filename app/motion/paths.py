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
from app.motion.repository import FrameOfDrive


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
    rows = repository.boxes_of_tracks(session, labelling_id, track_ids)
    if not rows:
        return {}
    boxes = np.array(rows, np.float64)
    frame_index = boxes[:, 1].astype(np.int64)
    path = _to_path(boxes, repository.frames_between(session, drive_id, *_span(frame_index)))
    track_id = boxes[:, 0].astype(np.int64)
    starts = np.flatnonzero(np.r_[True, track_id[1:] != track_id[:-1]])
    stops = [*starts[1:].tolist(), len(rows)]
    return {int(track_id[start]): path[slice(start, stop)] for start, stop in zip(starts.tolist(), stops, strict=True)}


def _span(frame_index: NDArray[np.int64]) -> tuple[int, int]:
    return int(frame_index.min()), int(frame_index.max())


def _to_path(boxes: NDArray[np.float64], frames: Sequence[FrameOfDrive]) -> BoxPath:
    """Of ``boxes`` (N, 8), columns as in BoxOfTrack."""
    frame_index = boxes[:, 1].astype(np.int64)
    row = np.searchsorted([frame.frame_index for frame in frames], frame_index)
    x, y, yaw = boxes[:, 2], boxes[:, 3], boxes[:, 4]
    ego = np.array([(frame.ego_x_m, frame.ego_y_m, frame.ego_yaw_rad) for frame in frames], np.float64)[row]
    frame = PathFrame.EGO if np.isnan(ego).any() else PathFrame.CITY
    xy = np.stack([x, y], axis=1)
    if frame is PathFrame.CITY:
        turn = ego[:, 2]
        cos, sin = np.cos(turn), np.sin(turn)
        xy = np.stack([cos * x - sin * y, sin * x + cos * y], axis=1) + ego[:, :2]
        yaw = _wrapped(yaw + turn)
    return BoxPath(
        frame_index=frame_index,
        time_s=np.array([one.timestamp_ns for one in frames], np.int64)[row] / 1e9,
        xy_m=xy,
        yaw_rad=yaw,
        size_m=boxes[:, 5:8],
        ego_distance_m=np.hypot(x, y),
        frame=frame,
    )


def _wrapped(angle_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """Into -pi..pi."""
    return (angle_rad + math.pi) % (2 * math.pi) - math.pi
