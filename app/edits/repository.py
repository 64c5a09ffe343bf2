"""SQL about what people's edits do to a labelling."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from sqlalchemy import bindparam, func, select, update
from sqlalchemy.orm import Session

from app.edits.models import EffectRow
from app.edits.pieces import Cut, Pieces
from app.edits.types import PAIRING, SAYING, SHAPING, Effect, EffectKind, Place
from app.tracks.models import TrackRow

IDS_PER_QUERY = 1_000

# Every decision asks these: they are made once, since that takes longer than answering them.
_HOLDING = (EffectRow.labelling_id == bindparam("labelling_id"), EffectRow.active)
_CUTS = select(EffectRow.tracked_id, EffectRow.frame_index, EffectRow.made_track_id).where(
    *_HOLDING, EffectRow.kind == EffectKind.CUT
)
_PAIRING = select(EffectRow).where(*_HOLDING, EffectRow.kind.in_(PAIRING))
_NO_DONORS = select(EffectRow).where(*_HOLDING, EffectRow.kind == EffectKind.NO_DONOR)
_SAYINGS = select(EffectRow).where(
    *_HOLDING, EffectRow.tracked_id.in_(bindparam("tracked_ids", expanding=True)), EffectRow.kind.in_(SAYING)
)


class Word(NamedTuple):
    """What a person says of two places: ``kind`` is SAME, APART or OPEN. ``effect_id`` is None for a rejected merge."""

    kind: EffectKind
    place: Place
    other: Place
    effect_id: int | None
    review_id: int


def insert(session: Session, labelling_id: int, review_id: int, effects: Iterable[Effect], *, active: bool) -> None:
    session.add_all(
        [
            EffectRow(
                labelling_id=labelling_id,
                review_id=review_id,
                kind=effect.kind,
                tracked_id=effect.place.tracked_id,
                frame_index=effect.place.frame_index,
                other_tracked_id=effect.other and effect.other.tracked_id,
                other_frame_index=effect.other and effect.other.frame_index,
                until_frame=effect.until_frame,
                made_track_id=effect.made_track_id,
                value=dict(effect.value),
                active=active,
            )
            for effect in effects
        ]
    )
    session.flush()


def of_review(session: Session, labelling_id: int, review_id: int) -> Sequence[EffectRow]:
    """What an edit does to a labelling, undone or not."""
    query = select(EffectRow).where(EffectRow.labelling_id == labelling_id, EffectRow.review_id == review_id)
    return session.scalars(query.order_by(EffectRow.id)).all()


def set_active(session: Session, effect_ids: Iterable[int], *, active: bool) -> None:
    session.execute(update(EffectRow).where(EffectRow.id.in_(list(effect_ids))).values(active=active))


def to_effect(row: EffectRow) -> Effect:
    other = None
    if row.other_tracked_id is not None and row.other_frame_index is not None:
        other = Place(row.other_tracked_id, row.other_frame_index)
    return Effect(
        EffectKind(row.kind),
        Place(row.tracked_id, row.frame_index),
        other=other,
        until_frame=row.until_frame,
        made_track_id=row.made_track_id,
        value=row.value,
    )


def pieces(session: Session, labelling_id: int) -> Pieces:
    """How people have split the tracks of a labelling."""
    return Pieces(Cut(*row) for row in session.execute(_CUTS, {"labelling_id": labelling_id}))


def made_track_id(session: Session, labelling_id: int, place: Place) -> int | None:
    """The id that a track beginning at a place has, or had while it was not undone."""
    query = select(EffectRow.made_track_id).where(
        EffectRow.labelling_id == labelling_id,
        EffectRow.kind == EffectKind.CUT,
        EffectRow.tracked_id == place.tracked_id,
        EffectRow.frame_index == place.frame_index,
    )
    return session.scalars(query.limit(1)).one_or_none()


def last_track_id(session: Session, labelling_id: int) -> int:
    """The largest id that any track of the labelling has or had; 0 where there is none."""
    tracks = select(func.max(TrackRow.track_id)).where(TrackRow.labelling_id == labelling_id)
    effects = select(func.max(EffectRow.tracked_id), func.max(EffectRow.made_track_id)).where(
        EffectRow.labelling_id == labelling_id
    )
    known = [session.scalar(tracks), *session.execute(effects).one()]
    return max((number for number in known if number is not None), default=0)


def shaping(session: Session, labelling_id: int, tracked_id: int) -> list[Effect]:
    """What shapes a track as tracked, in the order in which it was said."""
    query = (
        select(EffectRow)
        .where(
            EffectRow.labelling_id == labelling_id,
            EffectRow.tracked_id == tracked_id,
            EffectRow.active,
            EffectRow.kind.in_(SHAPING),
        )
        .order_by(EffectRow.review_id, EffectRow.id)
    )
    return [to_effect(row) for row in session.scalars(query)]


def pairing(session: Session, labelling_id: int) -> list[Word]:
    """What edits say of two places each."""
    words: list[Word] = []
    for row in session.scalars(_PAIRING, {"labelling_id": labelling_id}):
        effect = to_effect(row)
        assert effect.other is not None
        words.append(Word(effect.kind, effect.place, effect.other, row.id, row.review_id))
    return words


def sayings(session: Session, labelling_id: int, tracked_ids: Iterable[int]) -> list[Effect]:
    """Classes, marks and comments on tracks as tracked, in the order in which they were said."""
    ids = sorted(set(tracked_ids))
    rows: list[EffectRow] = []
    for start in range(0, len(ids), IDS_PER_QUERY):
        some = ids[start : start + IDS_PER_QUERY]
        rows += session.scalars(_SAYINGS, {"labelling_id": labelling_id, "tracked_ids": some})
    return [to_effect(row) for row in sorted(rows, key=lambda row: (row.review_id, row.id))]


def no_donors(session: Session, labelling_id: int) -> list[Effect]:
    """What people say of boxes that may not give their label to others."""
    return [to_effect(row) for row in session.scalars(_NO_DONORS, {"labelling_id": labelling_id})]


def reviews_about(session: Session, labelling_id: int, tracked_id: int, *, without: int) -> Sequence[int]:
    """Other edits that hold and name a track as tracked."""
    query = select(EffectRow.review_id).where(
        EffectRow.labelling_id == labelling_id,
        EffectRow.active,
        EffectRow.review_id != without,
        (EffectRow.tracked_id == tracked_id) | (EffectRow.other_tracked_id == tracked_id),
    )
    return session.scalars(query.distinct().order_by(EffectRow.review_id)).all()


def comments(session: Session, labelling_id: int) -> list[tuple[int, Place]]:
    """Review and place of the comments that hold, the oldest first."""
    query = (
        select(EffectRow.review_id, EffectRow.tracked_id, EffectRow.frame_index)
        .where(EffectRow.labelling_id == labelling_id, EffectRow.kind == EffectKind.COMMENT, EffectRow.active)
        .order_by(EffectRow.review_id, EffectRow.id)
    )
    return [(review_id, Place(tracked_id, frame)) for review_id, tracked_id, frame in session.execute(query)]


def maker_of(session: Session, labelling_id: int, tracked_id: int) -> int | None:
    """The edit that made a track as tracked; None for a track of the machine."""
    query = select(EffectRow.review_id).where(
        EffectRow.labelling_id == labelling_id, EffectRow.kind == EffectKind.NEW, EffectRow.tracked_id == tracked_id
    )
    return session.scalars(query.limit(1)).one_or_none()


def track_made_by(session: Session, labelling_id: int, review_id: int) -> int | None:
    """The track as tracked that an edit made."""
    query = select(EffectRow.tracked_id).where(
        EffectRow.labelling_id == labelling_id, EffectRow.kind == EffectKind.NEW, EffectRow.review_id == review_id
    )
    return session.scalars(query.limit(1)).one_or_none()


def camera_of(session: Session, labelling_id: int, tracked_id: int) -> str | None:
    """The camera of a track as tracked, as edits name it; None where none does."""
    query = select(EffectRow).where(
        EffectRow.labelling_id == labelling_id,
        EffectRow.tracked_id == tracked_id,
        EffectRow.kind.in_((EffectKind.NEW, EffectKind.HIDE)),
    )
    row = session.scalars(query.limit(1)).one_or_none()
    return None if row is None else row.value["camera"]


def class_of_new(session: Session, labelling_id: int, tracked_id: int) -> str | None:
    """The class of a track that a person made; None for a track of the machine."""
    query = select(EffectRow).where(
        EffectRow.labelling_id == labelling_id, EffectRow.tracked_id == tracked_id, EffectRow.kind == EffectKind.NEW
    )
    row = session.scalars(query.limit(1)).one_or_none()
    return None if row is None else row.value["class_name"]
