"""SQL about what the labeler found: labellings, tracks and their boxes. Labels are next door."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from sqlalchemy import and_, bindparam, delete, func, insert, select, update
from sqlalchemy.orm import Session, aliased

from app.db.base import Base
from app.db.rows import plain_rows
from app.drives.models import CameraRow, DriveRow
from app.identities.models import IdentityRow
from app.merges.models import MergeRow
from app.tracks.models import LabellingRow, ObservationRow, TrackRow

BATCH = 5_000
IDS_PER_QUERY = 1_000

# A decision asks a few dozen questions of a few rows each: making a statement takes longer than answering it, so those
# are made once.
_WITH_IDS = (
    select(TrackRow)
    .where(
        TrackRow.labelling_id == bindparam("labelling_id"),
        TrackRow.track_id.in_(bindparam("track_ids", expanding=True)),
    )
    .order_by(TrackRow.track_id)
)
_OF_IDENTITIES = (
    select(TrackRow)
    .where(
        TrackRow.labelling_id == bindparam("labelling_id"),
        TrackRow.identity_id.in_(bindparam("identity_ids", expanding=True)),
    )
    .order_by(TrackRow.track_id)
)
_BESIDE = aliased(TrackRow)
_OF_SAME = (
    select(TrackRow)
    .where(
        TrackRow.labelling_id == bindparam("labelling_id"),
        TrackRow.identity_id.in_(
            select(_BESIDE.identity_id).where(
                _BESIDE.labelling_id == bindparam("labelling_id"),
                _BESIDE.track_id.in_(bindparam("track_ids", expanding=True)),
            )
        ),
    )
    .order_by(TrackRow.track_id)
)
# Not by pairs of both: SQLite finds these by no index.
_AT_PLACES = select(ObservationRow).where(
    ObservationRow.labelling_id == bindparam("labelling_id"),
    ObservationRow.track_id.in_(bindparam("track_ids", expanding=True)),
    ObservationRow.frame_index.in_(bindparam("frames", expanding=True)),
)


class LabellingCounts(NamedTuple):
    """How much a labelling holds, and the model that made it."""

    tracks: int
    identities: int
    observations: int
    proposed_merges: int
    model_name: str


class TrackFacts(NamedTuple):
    """A track as readers of all tracks need it: many times cheaper to read than rows that may be changed."""

    track_id: int
    camera_id: int
    identity_id: int
    first_frame: int
    last_frame: int
    observation_count: int
    best_score: float | None
    best_frame: int
    class_id: int


class Sighting(NamedTuple):
    """A track in one image, as the detector saw it; ``score`` is None where the tracker filled the box in."""

    track_id: int
    frame_index: int
    x1_px: float
    y1_px: float
    x2_px: float
    y2_px: float
    class_id: int
    score: float | None


class TrackedBox(NamedTuple):
    """A box of a track in one image."""

    track_id: int
    x1_px: float
    y1_px: float
    x2_px: float
    y2_px: float


def current_labelling(session: Session, drive_id: int) -> LabellingRow | None:
    """The labelling that readers see."""
    query = select(LabellingRow).where(LabellingRow.drive_id == drive_id, LabellingRow.current)
    return session.scalars(query).one_or_none()


def is_current(session: Session, labelling_id: int) -> bool:
    """Whether readers see this labelling."""
    return find_labelling(session, labelling_id).current


def drive_of_labelling(session: Session, labelling_id: int) -> DriveRow:
    return session.get_one(DriveRow, find_labelling(session, labelling_id).drive_id)


def counts_of_drives(session: Session, drive_ids: Sequence[int]) -> dict[int, LabellingCounts]:
    """Counts of each drive that has been labelled."""

    def count(table: type[TrackRow] | type[IdentityRow] | type[MergeRow], *where: Any) -> Any:
        query = select(func.count()).select_from(table).where(table.labelling_id == LabellingRow.id, *where)
        return query.correlate(LabellingRow).scalar_subquery()

    query = select(
        LabellingRow.drive_id,
        count(TrackRow),
        count(IdentityRow),
        LabellingRow.observation_count,
        count(MergeRow, MergeRow.state == "proposed"),
        LabellingRow.model_name,
    ).where(LabellingRow.drive_id.in_(drive_ids), LabellingRow.current)
    return {row[0]: LabellingCounts(*row[1:]) for row in session.execute(query)}


def insert_labelling(session: Session, labelling: LabellingRow) -> int:
    session.add(labelling)
    session.flush()
    return labelling.id


def insert_columns(session: Session, table: type[Base], columns: Mapping[str, Sequence[Any]]) -> None:
    """Add rows of one table in bulk, given column by column.

    Where the driver takes parameters by position, rows go to it as they are: a dict for each takes most of the time.
    """
    connection = session.connection()
    statement = insert(table)
    compiled = statement.compile(dialect=connection.dialect, column_keys=list(columns))
    names = compiled.positiontup
    if names is None:
        rows = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
        connection.execute(statement, rows)
    else:
        connection.exec_driver_sql(str(compiled), list(zip(*(columns[name] for name in names), strict=True)))


def find_labelling(session: Session, labelling_id: int) -> LabellingRow:
    """The labelling of that id, which must exist."""
    return session.get_one(LabellingRow, labelling_id)


def make_current(
    session: Session, labelling_id: int, *, drive_id: int, observation_count: int, since_revision: int
) -> None:
    """Let readers see this labelling of the drive, and no other. ``observation_count`` is without people's edits."""
    drive = LabellingRow.drive_id == drive_id
    session.execute(update(LabellingRow).where(drive).values(current=False))
    session.execute(
        update(LabellingRow)
        .where(LabellingRow.id == labelling_id)
        .values(
            current=True,
            observation_count=LabellingRow.observation_count + observation_count,
            since_revision=since_revision,
        )
    )


def replaced_labellings(session: Session, drive_id: int) -> Sequence[int]:
    """Labellings of the drive that nobody sees: replaced ones, and what broken imports left."""
    query = select(LabellingRow.id).where(LabellingRow.drive_id == drive_id, ~LabellingRow.current)
    return session.scalars(query).all()


def delete_some_tracks(session: Session, labelling_id: int, *, at_most: int) -> bool:
    """Delete some tracks of a labelling with their observations; whether there were any."""
    some = select(TrackRow.track_id).where(TrackRow.labelling_id == labelling_id).limit(at_most)
    track_ids = session.scalars(some).all()
    session.execute(
        delete(TrackRow).where(TrackRow.labelling_id == labelling_id, TrackRow.track_id.in_(track_ids)),
        execution_options={"synchronize_session": False},
    )
    return bool(track_ids)


def delete_labelling(session: Session, labelling_id: int) -> None:
    """Delete a labelling and all that is left of it; boxes that people deleted belong to no track."""
    session.execute(
        delete(ObservationRow).where(ObservationRow.labelling_id == labelling_id),
        execution_options={"synchronize_session": False},
    )
    session.execute(delete(LabellingRow).where(LabellingRow.id == labelling_id))


def tracks_of(session: Session, labelling_id: int) -> Sequence[TrackRow]:
    """All tracks, in order of id."""
    query = select(TrackRow).where(TrackRow.labelling_id == labelling_id).order_by(TrackRow.track_id)
    return session.scalars(query).all()


def track_facts(session: Session, labelling_id: int) -> list[TrackFacts]:
    """All tracks, in order of id, to read only."""
    columns = (getattr(TrackRow, name) for name in TrackFacts._fields)
    query = select(*columns).where(TrackRow.labelling_id == labelling_id).order_by(TrackRow.track_id)
    return [TrackFacts._make(row) for row in plain_rows(session, query)]


def tracks_of_identities(session: Session, labelling_id: int, identity_ids: Iterable[int]) -> Sequence[TrackRow]:
    """The tracks of a few identities, in order of id."""
    asked = {"labelling_id": labelling_id, "identity_ids": list(set(identity_ids))}
    return session.scalars(_OF_IDENTITIES, asked).all()


def tracks_of_same_identities(session: Session, labelling_id: int, track_ids: Iterable[int]) -> Sequence[TrackRow]:
    """All tracks of the identities that a few tracks are in, in order of id."""
    return session.scalars(_OF_SAME, {"labelling_id": labelling_id, "track_ids": sorted(track_ids)}).all()


def tracks_with(session: Session, labelling_id: int, track_ids: Iterable[int]) -> list[TrackRow]:
    """The tracks of these ids, in order of id."""
    ids = sorted(track_ids)
    return [
        track
        for start in range(0, len(ids), IDS_PER_QUERY)
        for track in session.scalars(
            _WITH_IDS, {"labelling_id": labelling_id, "track_ids": ids[start : start + IDS_PER_QUERY]}
        )
    ]


def frames_of_track(session: Session, labelling_id: int, track_id: int) -> set[int]:
    """The frames that a track has an observation in."""
    query = select(ObservationRow.frame_index).where(
        ObservationRow.labelling_id == labelling_id, ObservationRow.track_id == track_id
    )
    return set(session.scalars(query))


def observations_at(session: Session, labelling_id: int, places: Collection[tuple[int, int]]) -> list[ObservationRow]:
    """The observations at a few places (track and frame), which must have one each, in their order."""
    track_ids, frames = zip(*places, strict=True)
    asked = {"labelling_id": labelling_id, "track_ids": track_ids, "frames": frames}
    found = {(row.track_id, row.frame_index): row for row in session.scalars(_AT_PLACES, asked)}
    return [found[place] for place in places]


def sightings_of_tracks(session: Session, labelling_id: int, track_ids: Iterable[int]) -> list[Sighting]:
    """Every observation of some tracks, by track and frame."""
    query = (
        select(
            ObservationRow.track_id,
            ObservationRow.frame_index,
            ObservationRow.x1_px,
            ObservationRow.y1_px,
            ObservationRow.x2_px,
            ObservationRow.y2_px,
            ObservationRow.class_id,
            ObservationRow.score,
        )
        .where(ObservationRow.labelling_id == labelling_id)
        .order_by(ObservationRow.track_id, ObservationRow.frame_index)
    )
    ids = sorted(track_ids)
    return [
        Sighting._make(row)
        for start in range(0, len(ids), IDS_PER_QUERY)
        for row in session.execute(query.where(ObservationRow.track_id.in_(ids[start : start + IDS_PER_QUERY])))
    ]


def boxes_in_image(session: Session, labelling_id: int, camera_id: int, frame_index: int) -> list[TrackedBox]:
    """The boxes of all tracks in one image."""
    query = (
        select(
            ObservationRow.track_id,
            ObservationRow.x1_px,
            ObservationRow.y1_px,
            ObservationRow.x2_px,
            ObservationRow.y2_px,
        )
        .join(TrackRow, same_track(TrackRow, ObservationRow))
        .where(
            ObservationRow.labelling_id == labelling_id,
            ObservationRow.frame_index == frame_index,
            TrackRow.camera_id == camera_id,
        )
        .order_by(ObservationRow.track_id)
    )
    return [TrackedBox(*row) for row in session.execute(query)]


def scores_by_track(session: Session, labelling_id: int) -> list[tuple[int, int, float]]:
    """Track, frame and score of every observation, in order of track and frame; -1 where it has no score."""
    query = (
        select(ObservationRow.track_id, ObservationRow.frame_index, func.coalesce(ObservationRow.score, -1.0))
        .where(ObservationRow.labelling_id == labelling_id, ObservationRow.track_id.is_not(None))
        .order_by(ObservationRow.track_id, ObservationRow.frame_index)
    )
    return plain_rows(session, query)


def set_identity(session: Session, labelling_id: int, track_ids: Sequence[int], identity_id: int) -> None:
    """Put tracks into an identity."""
    session.execute(
        update(TrackRow)
        .where(TrackRow.labelling_id == labelling_id, TrackRow.track_id.in_(track_ids))
        .values(identity_id=identity_id)
    )


def camera_names(session: Session, drive_id: int) -> dict[int, str]:
    """Names of the drive's cameras by the store's id. Asked once in a session: a drive's cameras never change."""
    known: dict[int, dict[int, str]] = session.info.setdefault("camera_names", {})
    if drive_id not in known:
        query = select(CameraRow.id, CameraRow.name).where(CameraRow.drive_id == drive_id)
        known[drive_id] = dict(session.execute(query).all())
    return known[drive_id]


def same_track(a: Any, b: Any) -> Any:
    """That rows of two tables are of the same track."""
    return and_(a.labelling_id == b.labelling_id, a.track_id == b.track_id)
