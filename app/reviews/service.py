"""Recording what a person decides."""

from collections.abc import Sequence

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
    pair = (merge.track_a, merge.track_b)
    tracks = sorted(
        tracks_repository.tracks_with(session, merge.labelling_id, pair), key=lambda track: pair.index(track.track_id)
    )
    anchors = _anchors(session, drive.id, tracks)
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
            anchor_a=anchors[0].model_dump(),
            anchor_b=anchors[1].model_dump(),
            evidence=evidence.model_dump(),
            payload={"about": {"identity_ids": identity_ids, "track_ids": list(pair)}},
            revision=drive.revision + 1,
        ),
    )


def _anchors(session: Session, drive_id: int, tracks: Sequence[TrackRow]) -> list[TrackAnchor]:
    """The best observation of each track: the one that another run is most likely to find again."""
    cameras = tracks_repository.camera_names(session, drive_id)
    places = [(track.track_id, track.best_frame) for track in tracks]
    boxes = tracks_repository.observations_at(session, tracks[0].labelling_id, places)
    images = [(track.best_frame, track.camera_id) for track in tracks]
    times_ns = drives_repository.image_times_ns(session, drive_id, images)
    return [
        TrackAnchor(
            camera=cameras[track.camera_id],
            frame_index=track.best_frame,
            timestamp_ns=str(time_ns),
            box=(box.x1_px, box.y1_px, box.x2_px, box.y2_px),
        )
        for track, box, time_ns in zip(tracks, boxes, times_ns, strict=True)
    ]
