"""Recording what a person decides."""

from app.db.session import Session
from app.drives import repository as drives_repository
from app.merges.models import MergeRow
from app.reviews import repository
from app.reviews.models import ReviewRow
from app.reviews.schemas import MergeEvidence, ReviewAction, TrackAnchor
from app.tracks import repository as tracks_repository
from app.tracks.models import TrackRow


def record(session: Session, merge: MergeRow, action: ReviewAction, *, reviewer: str) -> None:
    """Append a decision about a merge of the current labelling."""
    drive = tracks_repository.drive_of_labelling(session, merge.labelling_id)
    assert merge.track_a is not None
    assert merge.track_b is not None
    tracks = {
        track.track_id: track
        for track in tracks_repository.tracks_with(session, merge.labelling_id, (merge.track_a, merge.track_b))
    }
    cameras = tracks_repository.camera_names(session, drive.id)
    anchors = [_anchor(session, drive.id, tracks[track], cameras) for track in (merge.track_a, merge.track_b)]
    identity_ids = sorted({track.identity_id for track in tracks.values()})
    evidence = MergeEvidence.model_validate(merge, from_attributes=True)
    repository.append_about_merge(
        session,
        ReviewRow(
            drive_id=drive.id,
            merge_id=merge.id,
            subject_id=repository.subject_of_merge(session, merge.id),
            action=action,
            reviewer=reviewer,
            anchor_a=anchors[0].model_dump(),
            anchor_b=anchors[1].model_dump(),
            evidence=evidence.model_dump(),
            payload={"about": {"identity_ids": identity_ids, "track_ids": [merge.track_a, merge.track_b]}},
            revision=drive.revision + 1,
        ),
    )


def _anchor(session: Session, drive_id: int, track: TrackRow, cameras: dict[int, str]) -> TrackAnchor:
    """A track's best observation: the one that another run is most likely to find again."""
    frame_index = track.best_frame
    box = tracks_repository.observation_at(session, track.labelling_id, track.track_id, frame_index)
    times = drives_repository.image_times_ns(session, drive_id, [frame_index], track.camera_id)
    return TrackAnchor(
        camera=cameras[track.camera_id],
        frame_index=frame_index,
        timestamp_ns=str(times[frame_index]),
        box=(box.x1_px, box.y1_px, box.x2_px, box.y2_px),
    )
