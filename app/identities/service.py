"""Identities for the page."""

from app.db.session import Session
from app.drives import repository as drives_repository
from app.errors import NotFound
from app.identities import repository
from app.identities.schemas import Identity, IdentityDonor, IdentityMark
from app.tracks import repository as tracks_repository
from app.tracks.models import TrackRow


def list_identities(session: Session, drive_id: int) -> list[Identity]:
    """Identities of a drive in order of id; none before it is labelled."""
    if drives_repository.find(session, drive_id) is None:
        raise NotFound(f"There is no drive {drive_id}. It may have been deleted.")
    labelling = tracks_repository.current_labelling(session, drive_id)
    if labelling is None:
        return []
    cameras = tracks_repository.camera_names(session, drive_id)
    members: dict[int, list[TrackRow]] = {}
    for track in tracks_repository.tracks_of(session, labelling.id):
        members.setdefault(track.identity_id, []).append(track)
    return [
        Identity(
            id=row.identity_id,
            class_name=labelling.class_names[row.class_id],
            score=row.score,
            camera_names=list(dict.fromkeys(cameras[track.camera_id] for track in members[row.identity_id])),
            track_ids=[track.track_id for track in members[row.identity_id]],
            first_frame=row.first_frame,
            last_frame=row.last_frame,
            observation_count=row.observation_count,
            propagated_count=row.propagated_count,
            donor=IdentityDonor(
                observation_id=donor_id,
                track_id=row.donor_track_id,
                camera=cameras[donor_camera_id],
                frame_index=row.donor_frame_index,
                score=donor_score,
            ),
            class_by_person=row.class_by_person,
            mark=None if row.mark is None else IdentityMark(row.mark),
            comment_count=row.comment_count,
        )
        for row, donor_id, donor_camera_id, donor_score in repository.list_all(session, labelling.id)
    ]
