"""SQL about people's decisions."""

from collections.abc import Iterable, Sequence

from sqlalchemy import func, select, update
from sqlalchemy.orm import Session

from app.reviews.models import ReviewRow

IDS_PER_QUERY = 1_000


def append(session: Session, review: ReviewRow) -> None:
    """Add a decision."""
    session.add(review)
    session.flush()


def append_about_merge(session: Session, review: ReviewRow) -> None:
    """Add a decision about a merge; the first one about two objects is its own subject."""
    append(session, review)
    if review.subject_id is None:
        review.subject_id = review.id
        session.flush()


def subject_of_merge(session: Session, merge_id: int) -> int | None:
    """The subject of the decisions about a merge, or None before the first."""
    query = select(ReviewRow.subject_id).where(ReviewRow.merge_id == merge_id).order_by(ReviewRow.id.desc()).limit(1)
    return session.scalars(query).one_or_none()


def latest_of_subjects(session: Session, drive_id: int) -> Sequence[ReviewRow]:
    """The decision about merges that holds for each subject of a drive, the oldest first."""
    latest = (
        select(func.max(ReviewRow.id))
        .where(ReviewRow.drive_id == drive_id, ReviewRow.subject_id.is_not(None), ~ReviewRow.undone)
        .group_by(ReviewRow.subject_id)
    )
    return session.scalars(select(ReviewRow).where(ReviewRow.id.in_(latest)).order_by(ReviewRow.id)).all()


def edits_that_hold(session: Session, drive_id: int) -> Sequence[ReviewRow]:
    """The decisions about other things than merges that are not undone, the oldest first."""
    query = select(ReviewRow).where(
        ReviewRow.drive_id == drive_id,
        ReviewRow.subject_id.is_(None),
        ReviewRow.target_id.is_(None),
        ~ReviewRow.undone,
    )
    return session.scalars(query.order_by(ReviewRow.id)).all()


def list_of_drive(session: Session, drive_id: int) -> Sequence[ReviewRow]:
    """All decisions about a drive, the oldest first."""
    return session.scalars(select(ReviewRow).where(ReviewRow.drive_id == drive_id).order_by(ReviewRow.id)).all()


def attach(session: Session, subject_id: int, *, merge_id: int | None, to_subject: int | None = None) -> None:
    """Let the decisions of a subject stand for a merge of the current labelling, or for none."""
    session.execute(
        update(ReviewRow)
        .where(ReviewRow.subject_id == subject_id)
        .values(merge_id=merge_id, subject_id=to_subject or subject_id)
    )


def find(session: Session, review_id: int) -> ReviewRow | None:
    return session.get(ReviewRow, review_id)


def find_all(session: Session, review_ids: Iterable[int]) -> Sequence[ReviewRow]:
    """The decisions of these ids."""
    ids = sorted(review_ids)
    return [
        row
        for start in range(0, len(ids), IDS_PER_QUERY)
        for row in session.scalars(select(ReviewRow).where(ReviewRow.id.in_(ids[start : start + IDS_PER_QUERY])))
    ]


def list_before(session: Session, drive_id: int, before: int | None, limit: int) -> Sequence[ReviewRow]:
    """Decisions about a drive that were made before another one, the newest first."""
    query = select(ReviewRow).where(ReviewRow.drive_id == drive_id)
    if before is not None:
        query = query.where(ReviewRow.id < before)
    return session.scalars(query.order_by(ReviewRow.id.desc()).limit(limit)).all()


def list_since(session: Session, drive_id: int, revision: int) -> Sequence[ReviewRow]:
    """Decisions about a drive after a revision of it, the oldest first."""
    query = select(ReviewRow).where(ReviewRow.drive_id == drive_id, ReviewRow.revision > revision)
    return session.scalars(query.order_by(ReviewRow.id)).all()


def latest_of_subject(session: Session, subject_id: int) -> ReviewRow | None:
    """The decision about a merge that holds; None where all are undone."""
    query = select(ReviewRow).where(ReviewRow.subject_id == subject_id, ~ReviewRow.undone)
    return session.scalars(query.order_by(ReviewRow.id.desc()).limit(1)).one_or_none()


def latest_to_undo(session: Session, drive_id: int, reviewer: str) -> ReviewRow | None:
    """The latest decision of a person that is not undone."""
    query = select(ReviewRow).where(
        ReviewRow.drive_id == drive_id,
        ReviewRow.reviewer == reviewer,
        ReviewRow.target_id.is_(None),
        ~ReviewRow.undone,
    )
    return session.scalars(query.order_by(ReviewRow.id.desc()).limit(1)).one_or_none()


def latest_to_redo(session: Session, drive_id: int, reviewer: str) -> ReviewRow | None:
    """What a person undid last and did not make again, unless the person has decided something new since."""
    own = (ReviewRow.drive_id == drive_id, ReviewRow.reviewer == reviewer)
    new = select(func.max(ReviewRow.id)).where(*own, ReviewRow.target_id.is_(None)).scalar_subquery()
    turns = (
        select(func.max(ReviewRow.id))
        .where(ReviewRow.drive_id == drive_id, ReviewRow.target_id.is_not(None))
        .group_by(ReviewRow.target_id)
    )
    undone = (
        select(ReviewRow.target_id)
        .where(*own, ReviewRow.id.in_(turns), ReviewRow.action == "undo_edit", ReviewRow.id > new)
        .order_by(ReviewRow.id.desc())
        .limit(1)
    )
    target_id = session.scalars(undone).one_or_none()
    return None if target_id is None else session.get_one(ReviewRow, target_id)
