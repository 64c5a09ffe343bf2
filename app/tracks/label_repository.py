"""SQL about labels: observations with theirs, and giving tracks other ones."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, cast

from sqlalchemy import CursorResult, and_, bindparam, exists, or_, select, true, update
from sqlalchemy.orm import Session, aliased

from app.db.rows import plain_rows
from app.tracks.models import LabelRow, ObservationRow, TrackRow
from app.tracks.repository import IDS_PER_QUERY, same_track

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
    """A box of the machine, and the label that it has now, in the order of LABEL_COLUMNS. ``filled`` is 0 or 1 where
    the driver gives that."""

    track_id: int
    camera_id: int
    frame_index: int
    x1_px: float
    y1_px: float
    x2_px: float
    y2_px: float
    score: float | None
    class_id: int
    filled: bool | int
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


def is_label_of_observation() -> Any:
    """That a label is that of an observation."""
    return and_(same_track(LabelRow, ObservationRow), LabelRow.frame_index == ObservationRow.frame_index)


class _Statements:
    """What is asked for labelled observations. Tracks and donors are asked beside, each once: they repeat from frame to
    frame. Made once for all: that takes longer than finding a few tracks or frames."""

    def __init__(self, which: Any, tracks: Any) -> None:
        """``which`` picks the observations, and ``tracks`` their tracks at least."""
        ours = and_(ObservationRow.labelling_id == bindparam("labelling_id"), which)
        self.observations = (
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
            .where(ours)
        )
        self.tracks = select(TrackRow.track_id, TrackRow.identity_id, TrackRow.camera_id).where(
            TrackRow.labelling_id == bindparam("labelling_id"), tracks
        )
        wanted = (
            select(LabelRow.donor_track_id, LabelRow.donor_frame_index)
            .join(ObservationRow, is_label_of_observation())
            .where(ours)
            .distinct()
            .subquery()
        )
        donor = aliased(ObservationRow)
        self.donors = (
            select(donor.track_id, donor.frame_index, donor.id, TrackRow.camera_id, donor.score)
            .select_from(wanted)
            .join(
                donor,
                and_(
                    donor.labelling_id == bindparam("labelling_id"),
                    donor.track_id == wanted.c.donor_track_id,
                    donor.frame_index == wanted.c.donor_frame_index,
                ),
            )
            .join(TrackRow, same_track(TrackRow, donor))
        )


_OF_FRAMES = _Statements(
    and_(ObservationRow.frame_index >= bindparam("start"), ObservationRow.frame_index < bindparam("stop")),
    and_(TrackRow.first_frame < bindparam("stop"), TrackRow.last_frame >= bindparam("start")),
)
_BOXES = (
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
    .where(
        ObservationRow.labelling_id == bindparam("labelling_id"),
        ObservationRow.track_id.in_(bindparam("track_ids", expanding=True)),
        ~ObservationRow.drawn,
    )
    .order_by(ObservationRow.track_id, ObservationRow.frame_index)
)
_CHANGE_LABEL = (
    update(LabelRow)
    .where(
        LabelRow.labelling_id == bindparam("of_labelling"),
        LabelRow.track_id == bindparam("of_track"),
        LabelRow.frame_index == bindparam("of_frame"),
    )
    .values({name: bindparam(f"new_{name}") for name in LABEL_COLUMNS})
)
_OF_TRACKS = _Statements(
    ObservationRow.track_id.in_(bindparam("track_ids", expanding=True)),
    TrackRow.track_id.in_(bindparam("track_ids", expanding=True)),
)


def labelled_frames(session: Session, labelling_id: int, start: int, stop: int) -> LabelledFrames:
    """Observations of the frames ``start <= frame_index < stop`` with their labels."""
    return _labelled(session, _OF_FRAMES, {"labelling_id": labelling_id, "start": start, "stop": stop})


def labelled_tracks(session: Session, labelling_id: int, track_ids: Sequence[int]) -> LabelledFrames:
    """All observations of some tracks with their labels."""
    return _labelled(session, _OF_TRACKS, {"labelling_id": labelling_id, "track_ids": track_ids})


def _labelled(session: Session, statements: _Statements, asked: Mapping[str, Any]) -> LabelledFrames:
    # Not by the store: it would go through all frames of the drive in their order to find those of a few tracks.
    observations = sorted(
        plain_rows(session, statements.observations, asked), key=lambda row: (row[FRAME_INDEX], row[TRACK_ID])
    )
    tracks = plain_rows(session, statements.tracks, asked)
    donors = plain_rows(session, statements.donors, asked)
    return LabelledFrames(
        [LabelledObservation._make(row) for row in observations],
        {track_id: TrackPlace(*place) for track_id, *place in tracks},
        {(track_id, frame_index): DonorObservation(*donor) for track_id, frame_index, *donor in donors},
    )


def boxes_of_tracks(session: Session, labelling_id: int, track_ids: Sequence[int]) -> list[BoxAndLabel]:
    """The boxes of some tracks that no person drew, by track and frame."""
    ids = sorted(track_ids)
    of_box = len(BoxAndLabel._fields) - 1
    return [
        BoxAndLabel._make((*row[:of_box], tuple(row[of_box:])))
        for start in range(0, len(ids), IDS_PER_QUERY)
        for row in plain_rows(
            session, _BOXES, {"labelling_id": labelling_id, "track_ids": ids[start : start + IDS_PER_QUERY]}
        )
    ]


def change_labels(session: Session, labelling_id: int, changed: Sequence[tuple[int, int, tuple[Any, ...]]]) -> None:
    """Give labels other values: track, frame, and the LABEL_COLUMNS."""
    if not changed:
        return
    names = ("of_labelling", "of_track", "of_frame", *(f"new_{name}" for name in LABEL_COLUMNS))
    rows = [
        dict(zip(names, (labelling_id, track_id, frame, *label), strict=True)) for track_id, frame, label in changed
    ]
    session.connection().execute(_CHANGE_LABEL, rows)


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
