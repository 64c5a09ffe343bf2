"""Merges for the page, and a person's decisions about them."""

from collections.abc import Iterable

from app.db.session import Session
from app.drives import repository as drives_repository
from app.edits import repository as edits_repository
from app.edits.types import EffectKind
from app.errors import Conflict, NotFound
from app.identities.classes import require_one_class
from app.identities.conflicts import require_one_object
from app.identities.linking import relink
from app.merges import repository
from app.merges.impact import Impact
from app.merges.models import MergeRow
from app.merges.priority import priority
from app.merges.schemas import DecidedBy, Merge, MergeChange, MergeEvidence, MergeFrame, MergeState
from app.reviews import service as reviews_service
from app.reviews.schemas import ReviewAction
from app.tracks import repository as tracks_repository


def list_merges(session: Session, drive_id: int, state: MergeState | None) -> list[Merge]:
    """Merges of a drive by descending score; none before it is labelled."""
    if drives_repository.find(session, drive_id) is None:
        raise NotFound(f"There is no drive {drive_id}. It may have been deleted.")
    labelling = tracks_repository.current_labelling(session, drive_id)
    if labelling is None:
        return []
    tracks = tracks_repository.tracks_of(session, labelling.id)
    impact = Impact(tracks, _held_pairs(session, labelling.id))
    cameras = tracks_repository.camera_names(session, drive_id)
    camera_of = {track.track_id: cameras[track.camera_id] for track in tracks}
    return [_to_merge(row, impact, camera_of) for row in repository.list_by_score(session, labelling.id, state)]


def accept_merge(session: Session, merge_id: int, *, reviewer: str) -> MergeChange:
    """A person says that the two tracks are one object.

    CannotLink where that would put two tracks of one camera that share a frame into one identity."""
    merge = require_current(session, merge_id)
    if merge.state != MergeState.ACCEPTED:
        _require_linkable(session, merge)
    return _decide(session, merge, ReviewAction.ACCEPT, MergeState.ACCEPTED, reviewer)


def reject_merge(session: Session, merge_id: int, *, reviewer: str) -> MergeChange:
    """A person says that the two tracks are two objects."""
    return _decide(session, require_current(session, merge_id), ReviewAction.REJECT, MergeState.REJECTED, reviewer)


def leave_merge_open(session: Session, merge_id: int, *, reviewer: str) -> MergeChange:
    """A person can't tell whether the two tracks are one object; they stay apart."""
    return _decide(session, require_current(session, merge_id), ReviewAction.UNSURE, MergeState.UNSURE, reviewer)


def undo_merge(session: Session, merge_id: int, *, reviewer: str) -> MergeChange:
    """What a person said is taken back, and what the machine said holds again, as far as it fits."""
    merge = require_current(session, merge_id)
    if merge.decided_by != DecidedBy.PERSON:
        raise Conflict(
            f"Nobody has decided about the merge of tracks {merge.track_a} and {merge.track_b}, so there is nothing to "
            "undo."
        )
    reviews_service.record(session, merge, ReviewAction.UNDO, reviewer=reviewer)
    merge.state, merge.decided_by = merge.machine_state, DecidedBy.MACHINE
    return _apply(session, merge)


def _decide(session: Session, merge: MergeRow, action: ReviewAction, state: MergeState, reviewer: str) -> MergeChange:
    if merge.state == state and merge.decided_by == DecidedBy.PERSON:
        return _change(session, merge, changed_label_count=0)  # said before: nothing to add
    reviews_service.record(session, merge, action, reviewer=reviewer)
    merge.state, merge.decided_by = state, DecidedBy.PERSON
    return _apply(session, merge)


def _apply(session: Session, merge: MergeRow) -> MergeChange:
    """Let identities and labels follow a changed merge."""
    relinked = relink(session, merge.labelling_id, tracks_of_merge(merge))
    drive = tracks_repository.drive_of_labelling(session, merge.labelling_id)
    drives_repository.raise_revision(session, drive.id)
    session.refresh(merge)
    return _change(session, merge, near=relinked.identity_ids, changed_label_count=relinked.changed_label_count)


def _change(session: Session, merge: MergeRow, *, near: Iterable[int] = (), changed_label_count: int) -> MergeChange:
    """``near`` are the identities that the decision reached, beside those of the merge's own tracks."""
    labelling_id = merge.labelling_id
    pair = tracks_repository.tracks_with(session, labelling_id, tracks_of_merge(merge))
    identity_ids = {track.identity_id for track in pair}
    reached = tracks_repository.tracks_of_identities(session, labelling_id, identity_ids | set(near))
    rows = repository.merges_of_tracks(session, labelling_id, [track.track_id for track in reached])
    tracks = tracks_repository.tracks_of_same_identities(
        session, labelling_id, {track for row in rows for track in tracks_of_merge(row)}
    )
    drive = tracks_repository.drive_of_labelling(session, labelling_id)
    session.refresh(drive)
    cameras = tracks_repository.camera_names(session, drive.id)
    impact = Impact(tracks, _held_pairs(session, labelling_id))
    camera_of = {track.track_id: cameras[track.camera_id] for track in tracks}
    return MergeChange(
        merge=_to_merge(merge, impact, camera_of),
        merges=[_to_merge(row, impact, camera_of) for row in rows],
        changed_label_count=changed_label_count,
        identity_ids=sorted(identity_ids),
        revision=drive.revision,
    )


def require_current(session: Session, merge_id: int) -> MergeRow:
    """The merge; NotFound where there is none, or where the drive has been labelled again since."""
    merge = repository.find(session, merge_id)
    if merge is None or not tracks_repository.is_current(session, merge.labelling_id):
        raise NotFound(f"There is no merge {merge_id}. The drive may have been labelled again: load its merges anew.")
    return merge


def _require_linkable(session: Session, merge: MergeRow) -> None:
    track_a, track_b = tracks_of_merge(merge)
    require_one_object(session, merge.labelling_id, (track_a, track_b))
    require_one_class(session, merge.labelling_id, (track_a, track_b))


def tracks_of_merge(merge: MergeRow) -> tuple[int, int]:
    """The merge's two tracks; NotFound where a person has deleted one."""
    if merge.track_a is None or merge.track_b is None:
        raise NotFound(f"A track of merge {merge.id} was deleted. Undo that first.")
    return merge.track_a, merge.track_b


def _held_pairs(session: Session, labelling_id: int) -> list[tuple[int, int]]:
    """What makes tracks one object now: merges, and what people joined."""
    pieces = edits_repository.pieces(session, labelling_id)
    joined = [pair for pair in edits_repository.pairs(session, labelling_id, pieces) if pair.kind is EffectKind.SAME]
    return [
        *repository.accepted_pairs(session, labelling_id),
        *((pair.track_a, pair.track_b) for pair in joined),
    ]


def _to_merge(row: MergeRow, impact: Impact, camera_of: dict[int, str]) -> Merge:
    label_count = impact.label_count(row)
    track_a, track_b = tracks_of_merge(row)
    return Merge(
        id=row.id,
        track_a=track_a,
        track_b=track_b,
        camera_a=camera_of[track_a],
        camera_b=camera_of[track_b],
        score=row.score,
        probability=row.score,
        state=MergeState(row.state),
        decided_by=DecidedBy(row.decided_by),
        shared_frames=row.shared_frames,
        agreeing_frames=row.agreeing_frames,
        mean_distance_m=row.mean_distance_m,
        mean_bev_iou=row.mean_bev_iou,
        reason=row.reason,
        best_frames=[MergeFrame.model_validate(frame) for frame in row.best_frames],
        evidence=MergeEvidence.model_validate(row.evidence) if row.evidence else None,
        label_count=label_count,
        priority=priority(label_count, row.score),
        identity_a=impact.identity_of(track_a),
        identity_b=impact.identity_of(track_b),
    )
