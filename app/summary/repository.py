"""SQL that counts labels."""

from typing import Any, NamedTuple

from sqlalchemy import Integer, and_, case, cast, func, literal, null, select
from sqlalchemy.orm import Session
from sqlalchemy.sql.elements import ColumnElement

from app.tracks.label_repository import is_label_of_observation
from app.tracks.models import Box3DRow, LabelRow, ObservationRow, TrackRow
from app.tracks.repository import same_track

SCORE_BINS = 100
MILLIONTHS = 1_000_000
"""Scores are kept with six digits, so as whole millionths they are binned without rounding errors."""


class LabelCount(NamedTuple):
    """How many labels are alike. Bins count from 0; None is an unknown score or distance."""

    class_id: int
    source: str
    score_bin: int | None
    own_score_bin: int | None
    distance_bin: int | None
    labels: int


def count_labels(session: Session, labelling_id: int, distance_edges_m: tuple[float, ...]) -> list[LabelCount]:
    """Labels by class, source, score of the label and of the detector, and distance of the track's 3D box there."""
    distance_bin = _distance_bin(distance_edges_m)
    columns = (
        LabelRow.class_id,
        LabelRow.source,
        _score_bin(LabelRow.score),
        _score_bin(ObservationRow.score),
        distance_bin,
    )
    query = (
        select(*columns, func.count())
        .select_from(ObservationRow)
        .join(LabelRow, is_label_of_observation())
        .join(TrackRow, same_track(TrackRow, ObservationRow))
        .outerjoin(
            Box3DRow,
            and_(
                Box3DRow.labelling_id == ObservationRow.labelling_id,
                Box3DRow.frame_index == ObservationRow.frame_index,
                Box3DRow.camera_id == TrackRow.camera_id,
                Box3DRow.track_id == ObservationRow.track_id,
            ),
        )
        .where(ObservationRow.labelling_id == labelling_id)
        .group_by(*columns)
    )
    return [LabelCount._make(row) for row in session.execute(query)]


def _score_bin(score: Any) -> ColumnElement[int]:
    """The hundredth that a score is in; 1 is in the last bin, for itself."""
    return cast(func.round(score * MILLIONTHS), Integer) // (MILLIONTHS // SCORE_BINS)


def _distance_bin(edges_m: tuple[float, ...]) -> ColumnElement[int]:
    """The number of the bin between two edges; the last one is open. Squares, as SQLite may have no root."""
    squared = Box3DRow.center_x_m * Box3DRow.center_x_m + Box3DRow.center_y_m * Box3DRow.center_y_m
    nearer = [(squared < edge * edge, literal(row)) for row, edge in enumerate(edges_m[1:])]
    return case((Box3DRow.center_x_m.is_(None), null()), *nearer, else_=literal(len(edges_m) - 1))
