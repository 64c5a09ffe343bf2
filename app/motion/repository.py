"""SQL about 3D boxes of tracks and where the car was."""

from collections.abc import Sequence
from typing import NamedTuple

from sqlalchemy import and_, select
from sqlalchemy.orm import Session

from app.drives.models import FrameRow
from app.identities.models import IdentityRow
from app.tracks.models import Box3DRow
from app.tracks.repository import IDS_PER_QUERY


class BoxOfTrack(NamedTuple):
    """A 3D box of a track in the ego frame of its frame [m, rad], and where the car was then (None: not recorded)."""

    track_id: int
    frame_index: int
    timestamp_ns: int
    center_x_m: float
    center_y_m: float
    yaw_rad: float
    length_m: float
    width_m: float
    height_m: float
    ego_x_m: float | None
    ego_y_m: float | None
    ego_yaw_rad: float | None


class EgoAt(NamedTuple):
    """Where the car was in a frame, seen from above, in the city frame [m, rad]."""

    frame_index: int
    x_m: float
    y_m: float
    yaw_rad: float


def boxes_of_tracks(session: Session, drive_id: int, labelling_id: int, track_ids: Sequence[int]) -> list[BoxOfTrack]:
    """The 3D boxes of some tracks by track and frame."""
    query = (
        select(
            Box3DRow.track_id,
            Box3DRow.frame_index,
            FrameRow.timestamp_ns,
            Box3DRow.center_x_m,
            Box3DRow.center_y_m,
            Box3DRow.yaw_rad,
            Box3DRow.length_m,
            Box3DRow.width_m,
            Box3DRow.height_m,
            FrameRow.ego_x_m,
            FrameRow.ego_y_m,
            FrameRow.ego_yaw_rad,
        )
        .join(FrameRow, and_(FrameRow.drive_id == drive_id, FrameRow.frame_index == Box3DRow.frame_index))
        .where(Box3DRow.labelling_id == labelling_id)
        .order_by(Box3DRow.track_id, Box3DRow.frame_index)
    )
    ids = sorted(track_ids)
    return [
        BoxOfTrack._make(row)
        for start in range(0, len(ids), IDS_PER_QUERY)
        for row in session.execute(query.where(Box3DRow.track_id.in_(ids[start : start + IDS_PER_QUERY])))
    ]


def classes_of_identities(session: Session, labelling_id: int) -> list[tuple[int, int]]:
    """The class id of every identity."""
    query = select(IdentityRow.identity_id, IdentityRow.class_id).where(IdentityRow.labelling_id == labelling_id)
    return [(identity_id, class_id) for identity_id, class_id in session.execute(query)]


def ego_between(session: Session, drive_id: int, first: int, last: int) -> list[EgoAt]:
    """Where the car was in the frames ``first <= frame_index <= last``; empty where that was not recorded."""
    query = (
        select(FrameRow.frame_index, FrameRow.ego_x_m, FrameRow.ego_y_m, FrameRow.ego_yaw_rad)
        .where(
            FrameRow.drive_id == drive_id,
            FrameRow.frame_index >= first,
            FrameRow.frame_index <= last,
            FrameRow.ego_x_m.is_not(None),
        )
        .order_by(FrameRow.frame_index)
    )
    return [EgoAt._make(row) for row in session.execute(query)]
