"""SQL about labels: observations with theirs, and giving tracks other ones."""

from collections.abc import Sequence
from typing import Any, NamedTuple, cast

from sqlalchemy import CursorResult, and_, bindparam, exists, or_, select, true, update
from sqlalchemy.orm import Session, aliased

from app.tracks.models import LabelRow, ObservationRow, TrackRow
from app.tracks.repository import IDS_PER_QUERY, plain_rows, same_track

LABEL_COLUMNS = ("class_id", "score", "source", "donor_track_id", "donor_frame_index", "withheld", "probability")


class LabelledObservation(NamedTuple):
    """An observation with its label. ``filled`` is 0 or 1 where the driver gives that."""

    id: int
    track_id: int
    frame_index: int
    x1_px: float
    y1_px: float
    x2_px: float
    y2_px: float
    class_id: int
    score: float | None
    filled: bool | int
    label_class_id: int
    label_score: float | None
    label_source: str
    donor_track_id: int
    donor_frame_index: int
    trust: float | None
    withheld: str | None
    probability: float | None


TRACK_ID, FRAME_INDEX = (LabelledObservation._fields.index(name) for name in ("track_id", "frame_index"))


class BoxAndLabel(NamedTuple):
    """A box of the machine, and the label that it has now, in the order of LABEL_COLUMNS."""

    track_id: int
    camera_id: int
    frame_index: int
    x1_px: float
    y1_px: float
    x2_px: float
    y2_px: float
    score: float | None
    class_id: int
    filled: bool
    trust: float | None
    label: tuple[Any, ...]


class TrackPlace(NamedTuple):
    """Where a track belongs."""

    identity_id: int
    camera_id: int


class DonorObservation(NamedTuple):
    """The observation that a label was taken from."""

    id: int
    camera_id: int
    score: float | None


class LabelledFrames(NamedTuple):
    """Observations of some frames by frame and track, and what they refer to: each track once, each donor once.

    ``donors`` go by track and frame."""

    observations: list[LabelledObservation]
    tracks: dict[int, TrackPlace]
    donors: dict[tuple[int, int], DonorObservation]


def labelled_frames(session: Session, labelling_id: int, start: int, stop: int) -> LabelledFrames:
    """Observations of the frames ``start <= frame_index < stop`` with their labels."""
    return _labelled(
        session,
        labelling_id,
        and_(ObservationRow.frame_index >= start, ObservationRow.frame_index < stop),
        and_(TrackRow.first_frame < stop, TrackRow.last_frame >= start),
    )


def labelled_tracks(session: Session, labelling_id: int, track_ids: Sequence[int]) -> LabelledFrames:
    """All observations of some tracks with their labels."""
    return _labelled(session, labelling_id, ObservationRow.track_id.in_(track_ids), TrackRow.track_id.in_(track_ids))


def _labelled(session: Session, labelling_id: int, which: Any, tracks: Any) -> LabelledFrames:
    """``which`` picks the observations, and ``tracks`` their tracks at least.

    Tracks and donors are read beside, not joined: they repeat from frame to frame.
    """
    query = (
        select(
            ObservationRow.id,
            ObservationRow.track_id,
            ObservationRow.frame_index,
            ObservationRow.x1_px,
            ObservationRow.y1_px,
            ObservationRow.x2_px,
            ObservationRow.y2_px,
            ObservationRow.class_id,
            ObservationRow.score,
            ObservationRow.filled,
            LabelRow.class_id,
            LabelRow.score,
            LabelRow.source,
            LabelRow.donor_track_id,
            LabelRow.donor_frame_index,
            ObservationRow.trust,
            LabelRow.withheld,
            LabelRow.probability,
        )
        .join(LabelRow, is_label_of_observation())
        .where(ObservationRow.labelling_id == labelling_id, which)
    )
    present = select(TrackRow.track_id, TrackRow.identity_id, TrackRow.camera_id).where(
        TrackRow.labelling_id == labelling_id, tracks
    )
    # Not by the store: it would go through all frames of the drive in their order to find those of a few tracks.
    observations = sorted(plain_rows(session, query), key=lambda row: (row[FRAME_INDEX], row[TRACK_ID]))
    return LabelledFrames(
        [LabelledObservation._make(row) for row in observations],
        {track_id: TrackPlace(*place) for track_id, *place in plain_rows(session, present)},
        _donors(session, labelling_id, which),
    )


def _donors(session: Session, labelling_id: int, which: Any) -> dict[tuple[int, int], DonorObservation]:
    """The donors of the labels of some observations, each once, by track and frame."""
    wanted = (
        select(LabelRow.donor_track_id, LabelRow.donor_frame_index)
        .join(ObservationRow, is_label_of_observation())
        .where(ObservationRow.labelling_id == labelling_id, which)
        .distinct()
        .subquery()
    )
    donor = aliased(ObservationRow)
    query = (
        select(donor.track_id, donor.frame_index, donor.id, TrackRow.camera_id, donor.score)
        .select_from(wanted)
        .join(
            donor,
            and_(
                donor.labelling_id == labelling_id,
                donor.track_id == wanted.c.donor_track_id,
                donor.frame_index == wanted.c.donor_frame_index,
            ),
        )
        .join(TrackRow, same_track(TrackRow, donor))
    )
    return {
        (track_id, frame_index): DonorObservation(observation_id, camera_id, score)
        for track_id, frame_index, observation_id, camera_id, score in plain_rows(session, query)
    }


def boxes_of_tracks(session: Session, labelling_id: int, track_ids: Sequence[int]) -> list[BoxAndLabel]:
    """The boxes of some tracks that no person drew, by track and frame."""
    query = (
        select(
            ObservationRow.track_id,
            TrackRow.camera_id,
            ObservationRow.frame_index,
            ObservationRow.x1_px,
            ObservationRow.y1_px,
            ObservationRow.x2_px,
            ObservationRow.y2_px,
            ObservationRow.score,
            ObservationRow.class_id,
            ObservationRow.filled,
            ObservationRow.trust,
            *(getattr(LabelRow, name) for name in LABEL_COLUMNS),
        )
        .join(TrackRow, same_track(TrackRow, ObservationRow))
        .join(LabelRow, is_label_of_observation())
        .where(ObservationRow.labelling_id == labelling_id, ~ObservationRow.drawn)
        .order_by(ObservationRow.track_id, ObservationRow.frame_index)
    )
    ids = sorted(track_ids)
    of_box = len(BoxAndLabel._fields) - 1
    return [
        BoxAndLabel._make((*row[:of_box], tuple(row[of_box:])))
        for start in range(0, len(ids), IDS_PER_QUERY)
        for row in session.execute(query.where(ObservationRow.track_id.in_(ids[start : start + IDS_PER_QUERY])))
    ]


def change_labels(session: Session, labelling_id: int, changed: Sequence[tuple[int, int, tuple[Any, ...]]]) -> None:
    """Give labels other values: track, frame, and the LABEL_COLUMNS."""
    if not changed:
        return
    statement = (
        update(LabelRow)
        .where(
            LabelRow.labelling_id == labelling_id,
            LabelRow.track_id == bindparam("of_track"),
            LabelRow.frame_index == bindparam("of_frame"),
        )
        .values({name: bindparam(f"new_{name}") for name in LABEL_COLUMNS})
    )
    names = ("of_track", "of_frame", *(f"new_{name}" for name in LABEL_COLUMNS))
    rows = [dict(zip(names, (track_id, frame, *label), strict=True)) for track_id, frame, label in changed]
    session.connection().execute(statement, rows)


def label_by_person(
    session: Session, labelling_id: int, track_ids: Sequence[int], *, class_id: int, score: float, drawn_only: bool
) -> int:
    """Let the labels of some tracks, or of their drawn boxes, be a person's word; how many labels change."""
    differs = or_(LabelRow.source != "human", LabelRow.class_id != class_id, LabelRow.score.is_distinct_from(score))
    ours = and_(LabelRow.labelling_id == labelling_id, LabelRow.track_id.in_(track_ids))
    changed = session.execute(
        update(LabelRow)
        .where(ours, differs, _is_drawn() if drawn_only else true())
        .values(
            class_id=class_id,
            score=score,
            source="human",
            donor_track_id=LabelRow.track_id,
            donor_frame_index=LabelRow.frame_index,
            withheld=None,
            probability=None,
        ),
        execution_options={"synchronize_session": False},
    )
    return cast("CursorResult[Any]", changed).rowcount


def _is_drawn() -> Any:
    """Whether a label is that of a box that a person drew."""
    return exists().where(is_label_of_observation(), ObservationRow.drawn)


def is_label_of_observation() -> Any:
    """That a label is that of an observation."""
    return and_(same_track(LabelRow, ObservationRow), LabelRow.frame_index == ObservationRow.frame_index)
