"""Undo and redo, without end: each is another decision, about an earlier one.

A decision that is undone has no effect, as if it had never been made; later ones stay. Where they would not fit without
it, undoing is refused. Undo goes back through the reviewer's own decisions, redo forward through what the reviewer
undid since the latest new one; any decision can be undone by its number.
"""

from typing import Any

from app.db.session import Session
from app.drives import repository as drives_repository
from app.drives.models import DriveRow
from app.edits import repository
from app.edits.anchors import EffectFinder
from app.edits.applying import apply
from app.edits.log import to_edit
from app.edits.schemas import EditAction
from app.edits.service import require_fresh, require_held, require_labelled, to_change
from app.edits.types import EffectKind
from app.errors import CannotLink, Conflict, NotFound
from app.identities.linking import Relinked, relink
from app.merges import repository as merges_repository
from app.reviews import repository as reviews_repository
from app.reviews.carrying import decide_merge
from app.reviews.models import ReviewRow
from app.reviews.schemas import ReviewAction
from app.tracks.models import LabellingRow

_NOTHING = Relinked((), 0, ())


def undo(
    session: Session, drive_id: int, edit_id: int | None, *, seen_revision: int | None, reviewer: str
) -> dict[str, Any]:
    """Take back the reviewer's latest decision, or the named one. NotFound, Conflict, CannotLink, Stale."""
    drive, labelling = require_labelled(session, drive_id)
    if edit_id is None:
        target = reviews_repository.latest_to_undo(session, drive_id, reviewer)
        if target is None:
            raise Conflict(f"{reviewer} has decided nothing here that could be undone. The log shows what others did.")
    else:
        target = _require(session, drive_id, edit_id)
        if target.undone:
            raise Conflict(f"Decision {edit_id} is undone already.")
    return _turn(session, drive, labelling, target, undone=True, seen_revision=seen_revision, reviewer=reviewer)


def redo(
    session: Session, drive_id: int, edit_id: int | None, *, seen_revision: int | None, reviewer: str
) -> dict[str, Any]:
    """Make the decision again that the reviewer undid last, or the named one. NotFound, Conflict, CannotLink, Stale."""
    drive, labelling = require_labelled(session, drive_id)
    if edit_id is None:
        target = reviews_repository.latest_to_redo(session, drive_id, reviewer)
        if target is None:
            raise Conflict(
                f"{reviewer} has undone nothing here since the latest decision, so there is nothing to redo."
            )
    else:
        target = _require(session, drive_id, edit_id)
        if not target.undone:
            raise Conflict(f"Decision {edit_id} is not undone.")
    return _turn(session, drive, labelling, target, undone=False, seen_revision=seen_revision, reviewer=reviewer)


def _require(session: Session, drive_id: int, edit_id: int) -> ReviewRow:
    row = reviews_repository.find(session, edit_id)
    if row is None or row.drive_id != drive_id or row.target_id is not None:
        raise NotFound(f"There is no decision {edit_id} about this drive that could be undone.")
    return row


def _turn(
    session: Session,
    drive: DriveRow,
    labelling: LabellingRow,
    target: ReviewRow,
    *,
    undone: bool,
    seen_revision: int | None,
    reviewer: str,
) -> dict[str, Any]:
    """Let a decision have no effect, or have it again, and add that to the log."""
    about = to_edit(target)
    require_fresh(session, drive, labelling, set(about.identity_ids), seen_revision)
    target.undone = undone
    reviews_repository.append(
        session,
        ReviewRow(
            drive_id=drive.id,
            action=EditAction.UNDO_EDIT if undone else EditAction.REDO_EDIT,
            reviewer=reviewer,
            anchor_a={},
            anchor_b={},
            evidence={},
            payload={"about": {"identity_ids": about.identity_ids, "track_ids": about.track_ids}},
            target_id=target.id,
            revision=drives_repository.raise_revision(session, drive.id),
        ),
    )
    if target.subject_id is not None:
        relinked = _turn_merge(session, labelling, target)
    else:
        relinked = _turn_effects(session, labelling, target, undone=undone)
    require_held(relinked)
    return to_change(session, drive, labelling, target, relinked)


def _turn_merge(session: Session, labelling: LabellingRow, target: ReviewRow) -> Relinked:
    """The latest decision about the merge that is not undone holds, else the machine's word."""
    merge = None if target.merge_id is None else merges_repository.find(session, target.merge_id)
    if merge is None or merge.track_a is None or merge.track_b is None:
        return _NOTHING
    assert target.subject_id is not None
    holding = reviews_repository.latest_of_subject(session, target.subject_id)
    decide_merge(merge, ReviewAction.UNDO if holding is None else ReviewAction(holding.action))
    return relink(session, labelling.id, (merge.track_a, merge.track_b))


def _turn_effects(session: Session, labelling: LabellingRow, target: ReviewRow, *, undone: bool) -> Relinked:
    rows = repository.of_review(session, labelling.id, target.id)
    if not rows and not undone:  # it was undone when the drive was labelled again
        finder = EffectFinder(session, labelling)
        found = [finder.find(payload, review_id=target.id) for payload in target.payload["effects"]]
        effects = [effect for effect in found if effect is not None]
        repository.insert(session, labelling.id, target.id, effects, active=True)
    else:
        effects = [repository.to_effect(row) for row in rows]
        repository.set_active(session, [row.id for row in rows], active=not undone)
    made = [effect.place.tracked_id for effect in effects if effect.kind is EffectKind.NEW]
    for tracked_id in made if undone else ():
        others = repository.reviews_about(session, labelling.id, tracked_id, without=target.id)
        if others:
            numbers = ", ".join(map(str, others))
            raise CannotLink(
                f"Other decisions are about the object that decision {target.id} drew: number {numbers} in the log. "
                "Undo them first."
            )
    return apply(session, labelling, effects)
