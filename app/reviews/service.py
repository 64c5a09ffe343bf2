"""Recording what a person decides."""

from app.db.session import Session
from app.drives import repository as drives_repository
from app.merges.models import MergeRow
from app.reviews import repository
from app.reviews.models import ReviewRow
from app.reviews.schemas import MergeEvidence, ReviewAction, TrackAnchor
from app.tracks import repository as tracks_repository


def record(session: Session, merge: MergeRow, action: ReviewAction, *, reviewer: str) -> None:
    """Append a decision about a merge of the current labelling."""
    drive = tracks_repository.drive_of_labelling(session, merge.labelling_id)
    assert merge.track_a is not None
    assert merge.track_b is not None
    tracks = tracks_repository.tracks_with(session, merge.labelling_id, (merge.track_a, merge.track_b))
    identity_ids = sorted({track.identity_id for track in tracks})
    evidence = MergeEvidence.model_validate(merge, from_attributes=True)
    repository.append_about_merge(
        session,
        ReviewRow(
            drive_id=drive.id,
            merge_id=merge.id,
            subject_id=repository.subject_of_merge(session, merge.id),
            action=action,
            reviewer=reviewer,
            anchor_a=_anchor(session, drive.id, merge.labelling_id, merge.track_a).model_dump(),
            anchor_b=_anchor(session, drive.id, merge.labelling_id, merge.track_b).model_dump(),
            evidence=evidence.model_dump(),
            payload={"about": {"identity_ids": identity_ids, "track_ids": [merge.track_a, merge.track_b]}},
            revision=drive.revision + 1,
        ),
    )


def _anchor(session: Session, drive_id: int, labelling_id: int, track_id: int) -> TrackAnchor:
    """A track's best observation: the one that another run is most likely to find again."""
    (track,) = tracks_repository.tracks_with(session, labelling_id, [track_id])
    frame_index = track.best_frame
    box = tracks_repository.observation_at(session, labelling_id, track_id, frame_index)
    times = drives_repository.image_times_ns(session, drive_id, [frame_index], track.camera_id)
    return TrackAnchor(
        camera=tracks_repository.camera_names(session, drive_id)[track.camera_id],
        frame_index=frame_index,
        timestamp_ns=str(times[frame_index]),
        box=(box.x1_px, box.y1_px, box.x2_px, box.y2_px),
    )
