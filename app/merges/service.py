"""Merges for the page, and a person's decisions about them."""

from typing import Any

from pydantic_core import to_json

from app.changes.service import change_values
from app.db.session import Session
from app.drives import repository as drives_repository
from app.drives.models import DriveRow
from app.edits import repository as edits_repository
from app.edits.pairs import pairs
from app.edits.service import require_fresh, require_held
from app.edits.types import Effect, EffectKind, Place
from app.errors import CannotLink, Conflict, NotFound
from app.identities.classes import require_one_class
from app.identities.conflicts import require_one_object
from app.identities.linking import Relinked, relink
from app.merges import repository
from app.merges.impact import Impact
from app.merges.models import MergeRow
from app.merges.schemas import DecidedBy, MergeState
from app.merges.values import merge_values
from app.reviews import service as reviews_service
from app.reviews.schemas import ReviewAction
from app.tracks import repository as tracks_repository
from app.tracks.models import LabellingRow


def merges_json(session: Session, drive_id: int, state: MergeState | None) -> bytes:
    """:class:`app.merges.schemas.Merge` of a drive's merges by descending score, as JSON; none before it is labelled.

    It is written from plain values: there are thousands, and models of each take most of the time. A test reads the
    answer back through the model.
    """
    if drives_repository.find(session, drive_id) is None:
        raise NotFound(f"There is no drive {drive_id}. It may have been deleted.")
    labelling = tracks_repository.current_labelling(session, drive_id)
    if labelling is None:
        return to_json([])
    tracks = tracks_repository.track_facts(session, labelling.id)
    impact = Impact(tracks, [*_joined(session, labelling.id), *repository.accepted_pairs(session, labelling.id)])
    cameras = tracks_repository.camera_names(session, drive_id)
    camera_of = {track.track_id: cameras[track.camera_id] for track in tracks}
    return to_json(
        [merge_values(row, impact, camera_of) for row in repository.read_by_score(session, labelling.id, state)]
    )


def accept_merge(session: Session, merge_id: int, *, reviewer: str, seen_revision: int | None = None) -> dict[str, Any]:
    """A person says that the two tracks are one object.

    CannotLink where that would put two tracks of one camera that share a frame into one identity; Stale, here as in all
    decisions, where one of the two objects was changed after the revision that the page had read."""
    merge = require_current(session, merge_id)
    return _decide(session, merge, ReviewAction.ACCEPT, MergeState.ACCEPTED, reviewer, seen_revision)


def reject_merge(session: Session, merge_id: int, *, reviewer: str, seen_revision: int | None = None) -> dict[str, Any]:
    """A person says that the two tracks are two objects. Where other merges tie them, the machine's weakest ones give
    way; CannotLink where people's own do."""
    merge = require_current(session, merge_id)
    return _decide(session, merge, ReviewAction.REJECT, MergeState.REJECTED, reviewer, seen_revision)


def leave_merge_open(
    session: Session, merge_id: int, *, reviewer: str, seen_revision: int | None = None
) -> dict[str, Any]:
    """A person can't tell whether the two tracks are one object; they stay apart."""
    merge = require_current(session, merge_id)
    return _decide(session, merge, ReviewAction.UNSURE, MergeState.UNSURE, reviewer, seen_revision)


def undo_merge(session: Session, merge_id: int, *, reviewer: str, seen_revision: int | None = None) -> dict[str, Any]:
    """What a person said is taken back, and what the machine said holds again, as far as it fits."""
    merge = require_current(session, merge_id)
    if merge.decided_by != DecidedBy.PERSON:
        raise Conflict(
            f"Nobody has decided about the merge of tracks {merge.track_a} and {merge.track_b}, so there is nothing to "
            "undo."
        )
    labelling = tracks_repository.find_labelling(session, merge.labelling_id)
    drive = tracks_repository.drive_of_labelling(session, labelling.id)
    _require_fresh(session, drive, labelling, merge, seen_revision)
    reviews_service.record(session, merge, ReviewAction.UNDO, reviewer=reviewer)
    merge.state, merge.decided_by = merge.machine_state, DecidedBy.MACHINE
    return _apply(session, drive, labelling, merge)


def _decide(
    session: Session,
    merge: MergeRow,
    action: ReviewAction,
    state: MergeState,
    reviewer: str,
    seen_revision: int | None,
) -> dict[str, Any]:
    labelling = tracks_repository.find_labelling(session, merge.labelling_id)
    drive = tracks_repository.drive_of_labelling(session, labelling.id)
    if merge.state == state and merge.decided_by == DecidedBy.PERSON:  # said before: nothing to add
        nothing = Relinked((), 0, (), joined=_joined(session, labelling.id))
        return _change(session, labelling, merge, nothing, revision=drive.revision)
    _require_fresh(session, drive, labelling, merge, seen_revision)
    if action is ReviewAction.ACCEPT and merge.state != MergeState.ACCEPTED:
        _require_linkable(session, merge)
    reviews_service.record(session, merge, action, reviewer=reviewer)
    merge.state, merge.decided_by = state, DecidedBy.PERSON
    return _apply(session, drive, labelling, merge)


def _apply(session: Session, drive: DriveRow, labelling: LabellingRow, merge: MergeRow) -> dict[str, Any]:
    """Let identities and labels follow a changed merge."""
    relinked = relink(session, labelling.id, tracks_of_merge(merge))
    if relinked.refused and merge.state == MergeState.REJECTED:
        first = relinked.refused[0]
        raise CannotLink(
            f"Tracks {merge.track_a} and {merge.track_b} are one object by what people decided: tracks {first.track_a} "
            f"and {first.track_b} are one. Undo that decision first."
        )
    require_held(relinked)
    revision = drives_repository.raise_revision(session, drive.id)
    return _change(session, labelling, merge, relinked, revision=revision)


def _change(
    session: Session, labelling: LabellingRow, merge: MergeRow, relinked: Relinked, *, revision: int
) -> dict[str, Any]:
    pair = tracks_of_merge(merge)
    values = change_values(session, labelling, relinked, revision=revision, beside=pair)
    [own] = [one for one in values["merges"] if one["id"] == merge.id]
    return values | {"merge": own, "identity_ids": sorted({own["identity_a"], own["identity_b"]})}


def require_current(session: Session, merge_id: int) -> MergeRow:
    """The merge; NotFound where there is none, or where the drive has been labelled again since."""
    merge = repository.find(session, merge_id)
    if merge is None or not tracks_repository.is_current(session, merge.labelling_id):
        raise NotFound(f"There is no merge {merge_id}. The drive may have been labelled again: load its merges anew.")
    return merge


def _require_fresh(
    session: Session, drive: DriveRow, labelling: LabellingRow, merge: MergeRow, seen_revision: int | None
) -> None:
    """Stale where somebody changed one of the two objects after the revision that the page had read."""
    if seen_revision is None or seen_revision >= drive.revision:
        return
    tracks = tracks_repository.tracks_with(session, merge.labelling_id, tracks_of_merge(merge))
    require_fresh(
        session,
        drive,
        labelling,
        {track.identity_id for track in tracks},
        seen_revision,
        track_ids={*tracks_of_merge(merge), merge.tracked_a, merge.tracked_b},
    )


def _require_linkable(session: Session, merge: MergeRow) -> None:
    track_a, track_b = tracks_of_merge(merge)
    lifted: list[Effect] = []
    if merge.state == MergeState.REJECTED:  # the acceptance takes the rejection's place
        places = Place(merge.tracked_a, merge.frame_a), Place(merge.tracked_b, merge.frame_b)
        lifted.append(Effect(EffectKind.OPEN, places[0], other=places[1]))
    require_one_object(session, merge.labelling_id, (track_a, track_b), lifted=lifted)
    require_one_class(session, merge.labelling_id, (track_a, track_b))


def tracks_of_merge(merge: MergeRow) -> tuple[int, int]:
    """The merge's two tracks; NotFound where a person has deleted one."""
    if merge.track_a is None or merge.track_b is None:
        raise NotFound(f"A track of merge {merge.id} was deleted. Undo that first.")
    return merge.track_a, merge.track_b


def _joined(session: Session, labelling_id: int) -> tuple[tuple[int, int], ...]:
    """The pairs of tracks that people joined."""
    said = pairs(session, labelling_id, edits_repository.pieces(session, labelling_id))
    return tuple((pair.track_a, pair.track_b) for pair in said if pair.kind is EffectKind.SAME)
