"""Identities for the page."""

from collections.abc import Iterable
from typing import Any

from pydantic_core import to_json

from app.db.session import Session
from app.drives import repository as drives_repository
from app.errors import NotFound
from app.identities import repository
from app.identities.repository import StoredIdentity
from app.tracks import repository as tracks_repository
from app.tracks.models import LabellingRow, TrackRow
from app.tracks.repository import TrackFacts


def identities_json(session: Session, drive_id: int) -> bytes:
    """:class:`app.identities.schemas.Identity` of a drive's identities in order of id, as JSON; none before it is
    labelled. It is written from plain values, as there are thousands."""
    if drives_repository.find(session, drive_id) is None:
        raise NotFound(f"There is no drive {drive_id}. It may have been deleted.")
    labelling = tracks_repository.current_labelling(session, drive_id)
    if labelling is None:
        return to_json([])
    tracks = tracks_repository.track_facts(session, labelling.id)
    return to_json(_values(session, labelling, repository.list_stored(session, labelling.id), tracks))


def values_of_identities(
    session: Session, labelling: LabellingRow, identity_ids: Iterable[int], tracks: Iterable[TrackRow]
) -> list[dict[str, Any]]:
    """The values of :class:`app.identities.schemas.Identity` of a few identities, in order of id; ``tracks`` are all
    of theirs."""
    return _values(session, labelling, repository.list_stored(session, labelling.id, set(identity_ids)), tracks)


def _values(
    session: Session,
    labelling: LabellingRow,
    rows: Iterable[StoredIdentity],
    tracks: Iterable[TrackRow | TrackFacts],
) -> list[dict[str, Any]]:
    """``tracks`` are all that the identities have, in order of id."""
    cameras = tracks_repository.camera_names(session, labelling.drive_id)
    members: dict[int, list[TrackRow | TrackFacts]] = {}
    for track in tracks:
        members.setdefault(track.identity_id, []).append(track)
    names = labelling.class_names
    return [
        {
            "id": row.identity_id,
            "class_name": names[row.class_id],
            "score": row.score,
            "camera_names": list(dict.fromkeys(cameras[track.camera_id] for track in members[row.identity_id])),
            "track_ids": [track.track_id for track in members[row.identity_id]],
            "first_frame": row.first_frame,
            "last_frame": row.last_frame,
            "observation_count": row.observation_count,
            "propagated_count": row.propagated_count,
            "donor": {
                "observation_id": row.donor_id,
                "track_id": row.donor_track_id,
                "camera": cameras[row.donor_camera_id],
                "frame_index": row.donor_frame_index,
                "score": row.donor_score,
            },
            "class_by_person": row.class_by_person,
            "mark": row.mark,
            "comment_count": row.comment_count,
        }
        for row in rows
    ]
