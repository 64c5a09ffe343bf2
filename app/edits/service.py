"""Corrections by people: making one, the log of all decisions, comments.

A correction is a review with its effects in terms that outlive the labelling; the same effects in terms of the current
labelling; and what follows from them for tracks, identities and labels. All in one transaction.
"""

from collections.abc import Collection
from typing import Any

from app.changes.service import change_values
from app.db.session import Session
from app.drives import repository as drives_repository
from app.drives.models import DriveRow
from app.drives.service import require_drive
from app.edits import repository
from app.edits.anchors import to_payload
from app.edits.applying import apply
from app.edits.deciding import Decided, decide
from app.edits.log import to_edit
from app.edits.schemas import (
    AnyEdit,
    BoxEdit,
    Comment,
    DonorEdit,
    DriveRevision,
    Edit,
    EditPage,
    InterpolateEdit,
    SplitEdit,
)
from app.edits.subjects import Subjects
from app.errors import CannotLink, Conflict, NotFound, Stale
from app.identities.linking import Refused, Relinked
from app.reviews import repository as reviews_repository
from app.reviews.models import ReviewRow
from app.tracks import repository as tracks_repository
from app.tracks.models import LabellingRow

PAGE = 100


def make_edit(
    session: Session, drive_id: int, edit: AnyEdit, *, seen_revision: int | None, reviewer: str
) -> dict[str, Any]:
    """Correct the labels of a drive.

    NotFound, InvalidRequest, CannotLink, ClassesDiffer; Stale where the same objects were changed since
    ``seen_revision``; Conflict before the drive is labelled."""
    drive, labelling = require_labelled(session, drive_id)
    require_fresh(session, drive, labelling, _named(edit), seen_revision)
    decided = decide(session, Subjects(session, drive, labelling), edit)
    require_fresh(session, drive, labelling, set(decided.about["identity_ids"]), seen_revision)
    review = _record(session, drive, labelling, edit.kind, decided, reviewer)
    relinked = apply(session, labelling, decided.effects)
    require_held(relinked)
    return to_change(session, drive, labelling, review, relinked)


def _named(edit: AnyEdit) -> set[int]:
    """The identities that an edit names; they may be gone."""
    match edit:
        case SplitEdit() | InterpolateEdit():
            return set()
        case BoxEdit():
            return set() if edit.identity_id is None else {edit.identity_id}
        case DonorEdit():
            return {edit.identity_id}
        case _:
            return set(edit.identity_ids)


def require_labelled(session: Session, drive_id: int) -> tuple[DriveRow, LabellingRow]:
    """The drive and its current labelling; NotFound, Conflict."""
    drive = require_drive(session, drive_id)
    labelling = tracks_repository.current_labelling(session, drive_id)
    if labelling is None:
        raise Conflict(f"Drive {drive.name} has no labels to correct yet. Label it first.")
    return drive, labelling


def require_fresh(
    session: Session,
    drive: DriveRow,
    labelling: LabellingRow,
    identity_ids: set[int],
    seen_revision: int | None,
    *,
    track_ids: Collection[int] = (),
) -> None:
    """Stale where one of these identities or tracks was changed after the revision that the page had read, or all were.

    What was a part of an object until then is known by its track: a split gives it another identity."""
    if seen_revision is None or seen_revision >= drive.revision:
        return
    if seen_revision < labelling.since_revision:
        raise Stale("The drive was labelled again since this page read it, so nothing was changed. Look again.")
    for review in reviews_repository.list_since(session, drive.id, seen_revision):
        changed = to_edit(review)
        if not identity_ids.isdisjoint(changed.identity_ids) or not set(track_ids).isdisjoint(changed.track_ids):
            objects = ", ".join(f"#{identity}" for identity in changed.identity_ids)
            raise Stale(
                f"{review.reviewer} changed object {objects} in the meantime ({review.action}, number {review.id} in "
                "the log), so nothing was changed now. Look at it, and repeat what you want."
            )


def require_held(relinked: Relinked) -> None:
    """CannotLink where decisions of persons don't fit together now."""
    if not relinked.refused:
        return
    one: Refused = relinked.refused[0]
    a, b = one.forbidden
    why = (
        "they are in one camera in the same frame"
        if one.apart is None
        else f"a person said that they are two objects (number {one.apart.review_id} in the log)"
    )
    raise CannotLink(
        f"It doesn't fit with what people decided: tracks {one.track_a} and {one.track_b} are one object, so tracks "
        f"{a} and {b} would be too, but {why}. Undo the decision that is wrong first."
    )


def _record(
    session: Session, drive: DriveRow, labelling: LabellingRow, action: str, decided: Decided, reviewer: str
) -> ReviewRow:
    review = ReviewRow(
        drive_id=drive.id,
        action=action,
        reviewer=reviewer,
        anchor_a={},
        anchor_b={},
        evidence={},
        payload={"about": decided.about, "effects": []},
        revision=drives_repository.raise_revision(session, drive.id),
    )
    reviews_repository.append(session, review)
    repository.insert(session, labelling.id, review.id, decided.effects, active=True)
    payloads = [to_payload(session, labelling, effect, review_id=review.id) for effect in decided.effects]
    review.payload = {"about": decided.about, "effects": payloads}
    session.flush()
    return review


def to_change(
    session: Session, drive: DriveRow, labelling: LabellingRow, review: ReviewRow, relinked: Relinked
) -> dict[str, Any]:
    """The values of an :class:`app.changes.schemas.EditChange`."""
    session.refresh(drive)
    values = change_values(session, labelling, relinked, revision=drive.revision)
    return values | {"edit": to_edit(review)}


def list_edits(session: Session, drive_id: int, *, before: int | None, limit: int, reviewer: str) -> EditPage:
    """The log of a drive's decisions, newest first."""
    require_drive(session, drive_id)
    rows = reviews_repository.list_before(session, drive_id, before, limit + 1)
    more = len(rows) > limit
    return EditPage(
        edits=[to_edit(row) for row in rows[:limit]],
        next_before=rows[limit - 1].id if more else None,
        undo=_to_optional(reviews_repository.latest_to_undo(session, drive_id, reviewer)),
        redo=_to_optional(reviews_repository.latest_to_redo(session, drive_id, reviewer)),
    )


def _to_optional(row: ReviewRow | None) -> Edit | None:
    return None if row is None else to_edit(row)


def list_comments(session: Session, drive_id: int, identity_id: int | None) -> list[Comment]:
    """Comments on the objects of a drive that are there now, the oldest first."""
    require_drive(session, drive_id)
    labelling = tracks_repository.current_labelling(session, drive_id)
    if labelling is None:
        return []
    pieces = repository.pieces(session, labelling.id)
    found = [(review, pieces.track_at(place)) for review, place in repository.comments(session, labelling.id)]
    tracks = tracks_repository.tracks_with(session, labelling.id, {track for _, track in found})
    identity_of = {track.track_id: track.identity_id for track in tracks}
    reviews = {row.id: row for row in reviews_repository.find_all(session, {review for review, _ in found})}
    return [
        Comment(
            edit_id=review,
            identity_id=identity_of[track],
            text=reviews[review].payload["about"]["text"],
            reviewer=reviews[review].reviewer,
            created_at=reviews[review].created_at,
        )
        for review, track in found
        if track in identity_of and identity_id in (None, identity_of[track])
    ]


def get_revision(session: Session, drive_id: int) -> DriveRevision:
    """The drive's revision, and the latest decision; NotFound."""
    drive = drives_repository.find(session, drive_id)
    if drive is None:
        raise NotFound(f"There is no drive {drive_id}. It may have been deleted.")
    latest = reviews_repository.list_before(session, drive_id, None, 1)
    return DriveRevision(revision=drive.revision, edit=to_edit(latest[0]) if latest else None)
