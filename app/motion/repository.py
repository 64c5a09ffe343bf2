"""SQL about 3D boxes of tracks and where the car was."""

from collections.abc import Sequence
from typing import NamedTuple

from sqlalchemy import and_, func, select
from sqlalchemy.orm import Session

from app.db.rows import plain_rows
from app.drives.models import FrameRow
from app.identities.models import IdentityRow
from app.tracks.models import Box3DRow, ObservationRow, TrackRow
from app.tracks.repository import IDS_PER_QUERY, same_track


class BoxOfTrack(NamedTuple):
    """A 3D box of a track in the ego frame of its frame [m, rad]."""

    track_id: int
    frame_index: int
    center_x_m: float
    center_y_m: float
    yaw_rad: float
    length_m: float
    width_m: float
    height_m: float


class FrameOfDrive(NamedTuple):
    """When a frame was, and where the car was then in the city frame [m, rad]; None where that was not recorded."""

    frame_index: int
    timestamp_ns: int
    ego_x_m: float | None
    ego_y_m: float | None
    ego_yaw_rad: float | None


class EgoAt(NamedTuple):
    """Where the car was in a frame, seen from above, in the city frame [m, rad]."""

    frame_index: int
    x_m: float
    y_m: float
    yaw_rad: float


class PlaceOfObservation(NamedTuple):
    """Where the object of an observation is, in the ego frame of its frame [m]; None where it has no 3D box."""

    observation_id: int
    x_m: float | None
    y_m: float | None


def places_of_observations(
    session: Session, labelling_id: int, observation_ids: Sequence[int]
) -> list[PlaceOfObservation]:
    """By the 3D box that the track of each observation has in its frame, made for its own camera."""
    query = (
        select(ObservationRow.id, Box3DRow.center_x_m, Box3DRow.center_y_m)
        .join(TrackRow, same_track(TrackRow, ObservationRow))
        .outerjoin(
            Box3DRow,
            and_(
                same_track(Box3DRow, ObservationRow),
                Box3DRow.frame_index == ObservationRow.frame_index,
                Box3DRow.camera_id == TrackRow.camera_id,
            ),
        )
        .where(ObservationRow.labelling_id == labelling_id, ObservationRow.id.in_(observation_ids))
        .order_by(ObservationRow.id)
    )
    return [PlaceOfObservation._make(row) for row in session.execute(query)]


def boxes_of_tracks(session: Session, labelling_id: int, track_ids: Sequence[int]) -> list[BoxOfTrack]:
    """The 3D boxes of some tracks by track and frame; plain tuples in the order of BoxOfTrack, as they are many."""
    columns = (getattr(Box3DRow, name) for name in BoxOfTrack._fields)
    query = select(*columns).where(Box3DRow.labelling_id == labelling_id)
    query = query.order_by(Box3DRow.track_id, Box3DRow.frame_index)
    ids = sorted(track_ids)
    found: list[BoxOfTrack] = []
    for start in range(0, len(ids), IDS_PER_QUERY):
        found += plain_rows(session, query.where(Box3DRow.track_id.in_(ids[start : start + IDS_PER_QUERY])))
    return found


def trust_of_tracks(session: Session, labelling_id: int, track_ids: Sequence[int]) -> dict[int, tuple[float, int]]:
    """The sum of the trust in the boxes of some tracks, and how many boxes were judged; by track that has any."""
    query = (
        select(ObservationRow.track_id, func.sum(ObservationRow.trust), func.count(ObservationRow.trust))
        .where(ObservationRow.labelling_id == labelling_id, ObservationRow.trust.is_not(None))
        .group_by(ObservationRow.track_id)
    )
    ids = sorted(track_ids)
    found: dict[int, tuple[float, int]] = {}
    for start in range(0, len(ids), IDS_PER_QUERY):
        some = query.where(ObservationRow.track_id.in_(ids[start : start + IDS_PER_QUERY]))
        found |= {track_id: (total, count) for track_id, total, count in plain_rows(session, some)}
    return found


def frames_between(session: Session, drive_id: int, first: int, last: int) -> list[FrameOfDrive]:
    """The frames ``first <= frame_index <= last`` in order."""
    columns = (getattr(FrameRow, name) for name in FrameOfDrive._fields)
    query = select(*columns).where(
        FrameRow.drive_id == drive_id, FrameRow.frame_index >= first, FrameRow.frame_index <= last
    )
    return [FrameOfDrive._make(row) for row in plain_rows(session, query.order_by(FrameRow.frame_index))]


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
