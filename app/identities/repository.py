"""SQL about identities."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from sqlalchemy import and_, delete, func, insert, select
from sqlalchemy.orm import Session

from app.identities.models import IdentityRow
from app.tracks.models import LabelRow, ObservationRow, TrackRow


class StoredIdentity(NamedTuple):
    """An identity to read only, with the store's id, the camera and the score of its donor."""

    identity_id: int
    class_id: int
    score: float | None
    donor_track_id: int
    donor_frame_index: int
    first_frame: int
    last_frame: int
    observation_count: int
    propagated_count: int
    class_by_person: bool
    mark: str | None
    comment_count: int
    donor_id: int
    donor_camera_id: int
    donor_score: float | None


def list_stored(session: Session, labelling_id: int, identity_ids: Iterable[int] | None = None) -> list[StoredIdentity]:
    """Identities in order of id: all, or those of these ids that are there."""
    of_identity = (getattr(IdentityRow, name) for name in StoredIdentity._fields[:-3])
    query = (
        select(*of_identity, ObservationRow.id, TrackRow.camera_id, ObservationRow.score)
        .join(
            TrackRow,
            and_(TrackRow.labelling_id == IdentityRow.labelling_id, TrackRow.track_id == IdentityRow.donor_track_id),
        )
        .join(
            ObservationRow,
            and_(
                ObservationRow.labelling_id == IdentityRow.labelling_id,
                ObservationRow.track_id == IdentityRow.donor_track_id,
                ObservationRow.frame_index == IdentityRow.donor_frame_index,
            ),
        )
        .where(IdentityRow.labelling_id == labelling_id)
        .order_by(IdentityRow.identity_id)
    )
    if identity_ids is not None:
        query = query.where(IdentityRow.identity_id.in_(sorted(identity_ids)))
    return [StoredIdentity._make(row) for row in session.execute(query)]


def find(session: Session, labelling_id: int, identity_ids: Iterable[int]) -> Sequence[IdentityRow]:
    """The identities of these ids that are there, in order of id."""
    query = select(IdentityRow).where(
        IdentityRow.labelling_id == labelling_id, IdentityRow.identity_id.in_(sorted(identity_ids))
    )
    return session.scalars(query.order_by(IdentityRow.identity_id), execution_options={"populate_existing": True}).all()


def ignored(session: Session, labelling_id: int) -> set[int]:
    """The identities that a person marked as ignored."""
    query = select(IdentityRow.identity_id).where(
        IdentityRow.labelling_id == labelling_id, IdentityRow.mark == "ignored"
    )
    return set(session.scalars(query))


def replace(session: Session, labelling_id: int, gone: Iterable[int], rows: Sequence[Mapping[str, Any]]) -> None:
    """Delete identities by id, and add others as rows of columns."""
    session.execute(
        delete(IdentityRow).where(IdentityRow.labelling_id == labelling_id, IdentityRow.identity_id.in_(sorted(gone))),
        execution_options={"synchronize_session": False},
    )
    if rows:
        session.execute(insert(IdentityRow), rows)


def propagated_count(session: Session, labelling_id: int, track_ids: Sequence[int]) -> int:
    """How many labels of these tracks come from another observation."""
    query = select(func.count()).where(
        LabelRow.labelling_id == labelling_id, LabelRow.track_id.in_(track_ids), LabelRow.source == "propagated"
    )
    return session.scalars(query).one()
