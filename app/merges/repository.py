"""SQL about merges."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from sqlalchemy import bindparam, func, insert, select, tuple_, update
from sqlalchemy.orm import Session

from app.db.rows import plain_rows
from app.merges.models import MergeRow
from app.reviews.models import ReviewRow
from app.tracks.repository import IDS_PER_QUERY

# Every decision asks these: they are made once, since that takes longer than answering them. Where a merge has one of
# some tracks on either side, each side is asked for by its own index.
_OF_TRACKS = (
    MergeRow.labelling_id == bindparam("labelling_id"),
    MergeRow.track_a.is_not(None),
    MergeRow.track_b.is_not(None),
)
_SIDES = tuple(side.in_(bindparam("track_ids", expanding=True)) for side in (MergeRow.track_a, MergeRow.track_b))
_MERGES = tuple(select(MergeRow).where(*_OF_TRACKS, side) for side in _SIDES)
_ACCEPTED_BY_PERSON = (MergeRow.decided_by == "person") & (MergeRow.state == "accepted")
_ACCEPTED_BY_MACHINE = (MergeRow.decided_by == "machine") & (MergeRow.machine_state == "accepted")
_LINKS = tuple(
    select(MergeRow.id, MergeRow.track_a, MergeRow.track_b, MergeRow.score, MergeRow.state, MergeRow.decided_by).where(
        *_OF_TRACKS, _ACCEPTED_BY_PERSON | _ACCEPTED_BY_MACHINE, side
    )
    for side in _SIDES
)
_REVIEW_ID = func.max(ReviewRow.id)
_REJECTIONS = (
    select(MergeRow.tracked_a, MergeRow.frame_a, MergeRow.tracked_b, MergeRow.frame_b, _REVIEW_ID)
    .join(ReviewRow, ReviewRow.merge_id == MergeRow.id)
    .where(
        MergeRow.labelling_id == bindparam("labelling_id"),
        MergeRow.decided_by == "person",
        MergeRow.state == "rejected",
        ReviewRow.action == "reject",
        ~ReviewRow.undone,
    )
    .group_by(MergeRow.id)
    .order_by(_REVIEW_ID)
)


class Link(NamedTuple):
    """A merge that makes two tracks one object, or would if it fitted."""

    merge_id: int
    track_a: int
    track_b: int
    score: float
    state: str
    decided_by: str


class Rejection(NamedTuple):
    """A person's word that two tracks are two objects, and the review that holds it."""

    tracked_a: int
    frame_a: int
    tracked_b: int
    frame_b: int
    review_id: int


class StoredMerge(NamedTuple):
    """A merge as readers of all merges need it: many times cheaper to read than rows that may be changed."""

    id: int
    track_a: int
    track_b: int
    score: float
    state: str
    decided_by: str
    shared_frames: int
    agreeing_frames: int
    mean_distance_m: float | None
    mean_bev_iou: float | None
    reason: str
    best_frames: list[dict[str, Any]]
    evidence: dict[str, Any]

    @property
    def tracks(self) -> tuple[int, int]:
        return self.track_a, self.track_b


def insert_merges(session: Session, rows: Sequence[Mapping[str, Any]]) -> None:
    if rows:
        session.execute(insert(MergeRow), rows)


def add_merge(session: Session, merge: MergeRow) -> MergeRow:
    """Add one merge; gives it its id."""
    session.add(merge)
    session.flush()
    return merge


def find(session: Session, merge_id: int) -> MergeRow | None:
    return session.get(MergeRow, merge_id)


def find_pair(session: Session, labelling_id: int, track_a: int, track_b: int) -> MergeRow | None:
    """The merge of two tracks, the one with the highest score where there are several."""
    pairs = ((track_a, track_b), (track_b, track_a))
    query = select(MergeRow).where(
        MergeRow.labelling_id == labelling_id, tuple_(MergeRow.track_a, MergeRow.track_b).in_(pairs)
    )
    return session.scalars(query.order_by(MergeRow.score.desc(), MergeRow.id).limit(1)).one_or_none()


def list_by_score(session: Session, labelling_id: int, state: str | None = None) -> Sequence[MergeRow]:
    """Merges by descending score, of one state where it is named; without those of deleted tracks."""
    return session.scalars(_by_score(select(MergeRow), labelling_id, state)).all()


def read_by_score(session: Session, labelling_id: int, state: str | None = None) -> list[StoredMerge]:
    """The same merges, to read only."""
    columns = (getattr(MergeRow, name) for name in StoredMerge._fields)
    return [StoredMerge._make(row) for row in session.execute(_by_score(select(*columns), labelling_id, state))]


def _by_score(query: Any, labelling_id: int, state: str | None) -> Any:
    query = query.where(
        MergeRow.labelling_id == labelling_id, MergeRow.track_a.is_not(None), MergeRow.track_b.is_not(None)
    )
    if state is not None:
        query = query.where(MergeRow.state == state)
    return query.order_by(MergeRow.score.desc(), MergeRow.id)


def merges_of_tracks(session: Session, labelling_id: int, track_ids: Iterable[int]) -> Sequence[MergeRow]:
    """Merges that any of these tracks is in, by descending score, as the store has them now."""
    ids = sorted(track_ids)
    found: dict[int, MergeRow] = {}
    for start in range(0, len(ids), IDS_PER_QUERY):
        asked = {"labelling_id": labelling_id, "track_ids": ids[start : start + IDS_PER_QUERY]}
        for query in _MERGES:
            rows = session.scalars(query, asked, execution_options={"populate_existing": True})
            found |= {row.id: row for row in rows}
    return sorted(found.values(), key=lambda row: (-row.score, row.id))


def links_of_tracks(session: Session, labelling_id: int, track_ids: Iterable[int]) -> list[Link]:
    """Merges that a person accepted, and those that the machine accepted and no person decided, that any of these
    tracks is in."""
    ids = sorted(track_ids)
    found: dict[int, Link] = {}
    for start in range(0, len(ids), IDS_PER_QUERY):
        asked = {"labelling_id": labelling_id, "track_ids": ids[start : start + IDS_PER_QUERY]}
        for query in _LINKS:
            for row in plain_rows(session, query, asked):
                found[row[0]] = Link._make(row)
    return list(found.values())


def rejections(session: Session, labelling_id: int) -> list[Rejection]:
    """The merges that people rejected."""
    return [Rejection._make(row) for row in session.execute(_REJECTIONS, {"labelling_id": labelling_id})]


def accepted_pairs(
    session: Session, labelling_id: int, track_ids: Collection[int] | None = None
) -> list[tuple[int, int]]:
    """The tracks of the merges that hold, a person's first, by descending score; of those between some tracks only,
    where these are named."""
    query = (
        select(MergeRow.track_a, MergeRow.track_b)
        .where(
            MergeRow.labelling_id == labelling_id,
            MergeRow.state == "accepted",
            MergeRow.track_a.is_not(None),
            MergeRow.track_b.is_not(None),
        )
        .order_by(MergeRow.decided_by.desc(), MergeRow.score.desc(), MergeRow.id)
    )
    if track_ids is not None:
        query = query.where(MergeRow.track_a.in_(sorted(track_ids)))
    return plain_rows(session, query)


def set_state(session: Session, merge_ids: Iterable[int], state: str) -> None:
    """Set what holds for some merges, by whomever it was decided."""
    ids = list(merge_ids)
    if ids:
        session.execute(update(MergeRow).where(MergeRow.id.in_(ids)).values(state=state))
