"""SQL about people's decisions."""

from collections.abc import Sequence

from sqlalchemy import func, select, update
from sqlalchemy.orm import Session

from app.reviews.models import ReviewRow


def append(session: Session, review: ReviewRow) -> None:
    """Add a decision; the first one about two objects is its own subject."""
    session.add(review)
    session.flush()
    if review.subject_id is None:
        review.subject_id = review.id
        session.flush()


def subject_of_merge(session: Session, merge_id: int) -> int | None:
    """The subject of the decisions about a merge, or None before the first."""
    query = select(ReviewRow.subject_id).where(ReviewRow.merge_id == merge_id).order_by(ReviewRow.id.desc()).limit(1)
    return session.scalars(query).one_or_none()


def latest_of_subjects(session: Session, drive_id: int) -> Sequence[ReviewRow]:
    """The decision that holds for each subject of a drive, the oldest first."""
    latest = select(func.max(ReviewRow.id)).where(ReviewRow.drive_id == drive_id).group_by(ReviewRow.subject_id)
    return session.scalars(select(ReviewRow).where(ReviewRow.id.in_(latest)).order_by(ReviewRow.id)).all()


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
