"""SQL that reads a track as tracked, and gives its rows the form that edits ask for."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from sqlalchemy import delete, insert, literal, select, update
from sqlalchemy.orm import Session

from app.drives.models import ImageRow
from app.edits.boxes import DrawnBox
from app.edits.pieces import Span
from app.edits.types import Box
from app.merges.models import MergeRow
from app.tracks.models import Box3DRow, LabellingRow, LabelRow, ObservationRow, TrackRow

IDS_PER_QUERY = 1_000
_BULK = {"synchronize_session": False}


class TrackedBox(NamedTuple):
    """A box of a track as tracked, with the track that it belongs to now."""

    id: int
    frame_index: int
    track_id: int | None
    x1_px: float
    y1_px: float
    x2_px: float
    y2_px: float
    score: float | None
    class_id: int
    filled: bool
    drawn: bool

    @property
    def box(self) -> Box:
        return (self.x1_px, self.y1_px, self.x2_px, self.y2_px)


class MachineBox(NamedTuple):
    """A box of the machine in one image, with its track as tracked."""

    tracked_id: int
    x1_px: float
    y1_px: float
    x2_px: float
    y2_px: float


def boxes_of(session: Session, labelling_id: int, tracked_id: int) -> list[TrackedBox]:
    """All boxes of a track as tracked, deleted ones too, by frame."""
    query = (
        select(
            ObservationRow.id,
            ObservationRow.frame_index,
            ObservationRow.track_id,
            ObservationRow.x1_px,
            ObservationRow.y1_px,
            ObservationRow.x2_px,
            ObservationRow.y2_px,
            ObservationRow.score,
            ObservationRow.class_id,
            ObservationRow.filled,
            ObservationRow.drawn,
        )
        .where(ObservationRow.labelling_id == labelling_id, ObservationRow.tracked_id == tracked_id)
        .order_by(ObservationRow.frame_index)
    )
    return [TrackedBox(*row) for row in session.execute(query)]


def nearest_machine_box(session: Session, labelling_id: int, tracked_id: int, frame_index: int) -> TrackedBox | None:
    """The machine's box of a track as tracked that is nearest to a frame; None where a person made the track."""
    boxes = [box for box in boxes_of(session, labelling_id, tracked_id) if not box.drawn]
    return min(boxes, key=lambda box: abs(box.frame_index - frame_index), default=None)


def machine_boxes_in_image(session: Session, labelling_id: int, camera_id: int, frame_index: int) -> list[MachineBox]:
    """The machine's boxes in one image, deleted ones too."""
    cameras = (
        select(TrackRow.tracked_id)
        .where(TrackRow.labelling_id == labelling_id, TrackRow.camera_id == camera_id)
        .distinct()
    )
    query = (
        select(
            ObservationRow.tracked_id,
            ObservationRow.x1_px,
            ObservationRow.y1_px,
            ObservationRow.x2_px,
            ObservationRow.y2_px,
        )
        .where(
            ObservationRow.labelling_id == labelling_id,
            ObservationRow.frame_index == frame_index,
            ~ObservationRow.drawn,
            ObservationRow.tracked_id.in_(cameras),
        )
        .order_by(ObservationRow.tracked_id)
    )
    return [MachineBox(*row) for row in session.execute(query)]


def pieces_of(session: Session, labelling_id: int, tracked_ids: Iterable[int]) -> list[TrackRow]:
    """The tracks that some tracks as tracked consist of now."""
    ids = sorted(set(tracked_ids))
    query = select(TrackRow).where(TrackRow.labelling_id == labelling_id).order_by(TrackRow.track_id)
    return [
        track
        for start in range(0, len(ids), IDS_PER_QUERY)
        for track in session.scalars(query.where(TrackRow.tracked_id.in_(ids[start : start + IDS_PER_QUERY])))
    ]


def image_frames(session: Session, drive_id: int, camera_id: int, first: int, last: int) -> set[int]:
    """The frames ``first`` to ``last`` in which a camera has an image."""
    query = select(ImageRow.frame_index).where(
        ImageRow.drive_id == drive_id,
        ImageRow.camera_id == camera_id,
        ImageRow.frame_index >= first,
        ImageRow.frame_index <= last,
    )
    return set(session.scalars(query))


def put_tracks(session: Session, rows: Sequence[Mapping[str, Any]]) -> None:
    """Add tracks, or give those that are there these values; who is in which identity stays."""
    for values in rows:
        key = (values["labelling_id"], values["track_id"])
        track = session.get(TrackRow, key)
        if track is None:
            session.add(TrackRow(**values, identity_id=values["track_id"]))
            continue
        for name, value in values.items():
            setattr(track, name, value)
    session.flush()


def remove_tracks(session: Session, labelling_id: int, track_ids: Collection[int]) -> None:
    """Delete tracks that have no observation any more."""
    for track_id in track_ids:
        track = session.get(TrackRow, (labelling_id, track_id))
        if track is not None:
            session.delete(track)
    session.flush()


def set_track(session: Session, observation_ids: Sequence[int], track_id: int | None) -> None:
    """Put observations into a track, or into none."""
    for start in range(0, len(observation_ids), IDS_PER_QUERY):
        part = observation_ids[start : start + IDS_PER_QUERY]
        session.execute(
            update(ObservationRow).where(ObservationRow.id.in_(part)).values(track_id=track_id), execution_options=_BULK
        )


def delete_observations(session: Session, observation_ids: Sequence[int]) -> None:
    for start in range(0, len(observation_ids), IDS_PER_QUERY):
        part = observation_ids[start : start + IDS_PER_QUERY]
        session.execute(delete(ObservationRow).where(ObservationRow.id.in_(part)), execution_options=_BULK)


def draw(
    session: Session,
    labelling_id: int,
    tracked_id: int,
    drawn: Mapping[int, DrawnBox],
    *,
    class_id: int,
    track_of_frame: Mapping[int, int],
) -> None:
    """Add boxes that people made to a track as tracked, by frame."""
    rows = [
        {
            "labelling_id": labelling_id,
            "tracked_id": tracked_id,
            "track_id": track_of_frame[frame],
            "frame_index": frame,
            "x1_px": one.box[0],
            "y1_px": one.box[1],
            "x2_px": one.box[2],
            "y2_px": one.box[3],
            "score": None,
            "class_id": class_id,
            "filled": one.filled,
            "drawn": True,
        }
        for frame, one in drawn.items()
    ]
    if rows:
        session.execute(insert(ObservationRow), rows)


def label_anew(session: Session, labelling_id: int, track_ids: Collection[int]) -> None:
    """Give the observations of tracks labels of their own; what their identities make of them is another step."""
    where = (LabelRow.labelling_id == labelling_id, LabelRow.track_id.in_(track_ids))
    session.execute(delete(LabelRow).where(*where), execution_options=_BULK)
    columns = ("labelling_id", "track_id", "frame_index", "class_id", "score", "source")
    own = select(
        ObservationRow.labelling_id,
        ObservationRow.track_id,
        ObservationRow.frame_index,
        ObservationRow.class_id,
        ObservationRow.score,
        literal("auto"),
        ObservationRow.track_id,
        ObservationRow.frame_index,
    ).where(ObservationRow.labelling_id == labelling_id, ObservationRow.track_id.in_(track_ids))
    session.execute(insert(LabelRow).from_select([*columns, "donor_track_id", "donor_frame_index"], own))


def move_boxes_3d(
    session: Session, labelling_id: int, tracked_id: int, spans: Iterable[Span], frames: Collection[int]
) -> None:
    """Let the 3D boxes of a track as tracked belong to its pieces; to none in frames other than ``frames``."""
    ours = (Box3DRow.labelling_id == labelling_id, Box3DRow.tracked_id == tracked_id)
    for span in spans:
        here = sorted(frame for frame in frames if span.start <= frame and (span.stop is None or frame < span.stop))
        for start in range(0, len(here), IDS_PER_QUERY):
            part = here[start : start + IDS_PER_QUERY]
            session.execute(
                update(Box3DRow).where(*ours, Box3DRow.frame_index.in_(part)).values(track_id=span.track_id),
                execution_options=_BULK,
            )


def hide_boxes_3d(session: Session, labelling_id: int, tracked_id: int, frames: Sequence[int]) -> None:
    """Let the 3D boxes of a track as tracked belong to no track in some frames."""
    for start in range(0, len(frames), IDS_PER_QUERY):
        session.execute(
            update(Box3DRow)
            .where(
                Box3DRow.labelling_id == labelling_id,
                Box3DRow.frame_index.in_(frames[start : start + IDS_PER_QUERY]),
                Box3DRow.tracked_id == tracked_id,
            )
            .values(track_id=None),
            execution_options=_BULK,
        )


def merges_about(session: Session, labelling_id: int, tracked_ids: Iterable[int]) -> Sequence[MergeRow]:
    """The merges that are about some tracks as tracked."""
    ids = sorted(set(tracked_ids))
    query = select(MergeRow).where(
        MergeRow.labelling_id == labelling_id, MergeRow.tracked_a.in_(ids) | MergeRow.tracked_b.in_(ids)
    )
    return session.scalars(query).all()


def count_observations(session: Session, labelling_id: int, difference: int) -> None:
    """Tell the labelling that it has more or fewer observations."""
    session.execute(
        update(LabellingRow)
        .where(LabellingRow.id == labelling_id)
        .values(observation_count=LabellingRow.observation_count + difference),
        execution_options=_BULK,
    )
