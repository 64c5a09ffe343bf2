"""Giving a track as tracked the form that edits ask for: its boxes, its pieces, their labels and 3D boxes.

Everything is made from what the machine tracked and from the effects that hold, never from what was there before; so
whatever is undone, in whatever order, leaves what it would be without it.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, cast

from app.db.session import Session
from app.edits import repository
from app.edits import track_repository as tracks
from app.edits.boxes import BoxEdit, edited_boxes
from app.edits.pieces import Pieces, Span
from app.edits.track_repository import TrackedBox
from app.edits.types import Box, Effect, EffectKind, Place
from app.tracks.models import LabellingRow

_BOX_EDITS = (EffectKind.HIDE, EffectKind.BOX, EffectKind.FILL)


@dataclass(frozen=True)
class TrackedForm:
    """What a track as tracked is: its camera, and the class of boxes that people draw for it."""

    tracked_id: int
    camera_id: int
    class_id: int


def reshape(
    session: Session,
    labelling: LabellingRow,
    form: TrackedForm,
    pieces: Pieces,
) -> None:
    """Make the rows of one track as tracked fit its effects. Identities and their labels are not looked at."""
    effects = repository.shaping(session, labelling.id, form.tracked_id)
    found = tracks.boxes_of(session, labelling.id, form.tracked_id)
    machine = {box.frame_index: box for box in found if not box.drawn}
    edits = [_to_box_edit(effect) for effect in effects if effect.kind in _BOX_EDITS]
    reach = [*machine, *(edit.frame_index for edit in edits)]
    images = tracks.image_frames(
        session, labelling.drive_id, form.camera_id, min(reach, default=0), max(reach, default=0)
    )
    wanted = edited_boxes({frame: box.box for frame, box in machine.items()}, edits, images)
    spans = pieces.spans(form.tracked_id)
    before = {box.track_id for box in found if box.track_id is not None}
    barred = [effect for effect in effects if effect.kind is EffectKind.NO_DONOR]
    may_give = {frame for frame in wanted.kept if not any(effect.reaches(frame) for effect in barred)}
    rows = _piece_rows(labelling.id, form, spans, machine, wanted.kept | wanted.drawn.keys(), may_give)
    after = {row["track_id"] for row in rows}

    tracks.put_tracks(session, rows)
    tracks.set_track(session, [box.id for frame, box in machine.items() if frame not in wanted.kept], None)
    tracks.delete_observations(session, [box.id for box in found if box.drawn])
    for span in spans:
        here = [machine[frame].id for frame in wanted.kept if _within(span, frame)]
        tracks.set_track(session, here, span.track_id)
    track_of_frame = {frame: pieces.track_at(Place(form.tracked_id, frame)) for frame in wanted.drawn}
    tracks.draw(
        session, labelling.id, form.tracked_id, wanted.drawn, class_id=form.class_id, track_of_frame=track_of_frame
    )
    visible = wanted.kept | wanted.drawn.keys()
    tracks.hide_boxes_3d(session, labelling.id, form.tracked_id, sorted(machine.keys() - visible))
    tracks.move_boxes_3d(session, labelling.id, form.tracked_id, spans, machine.keys() & visible)
    tracks.label_anew(session, labelling.id, before | after)
    tracks.remove_tracks(session, labelling.id, before - after)
    tracks.count_observations(session, labelling.id, len(visible) - sum(box.track_id is not None for box in found))


def place_merges(session: Session, labelling_id: int, tracked_ids: Iterable[int], pieces: Pieces) -> None:
    """Let the merges about some tracks as tracked name the pieces that they are about."""
    ids = set(tracked_ids)
    merges = tracks.merges_about(session, labelling_id, ids)
    ends = {merge.tracked_a for merge in merges} | {merge.tracked_b for merge in merges}
    there = {track.track_id for track in tracks.pieces_of(session, labelling_id, ends)}
    for merge in merges:
        track_a = pieces.track_at(Place(merge.tracked_a, merge.frame_a))
        track_b = pieces.track_at(Place(merge.tracked_b, merge.frame_b))
        merge.track_a = track_a if track_a in there else None
        merge.track_b = track_b if track_b in there else None
    session.flush()


def _to_box_edit(effect: Effect) -> BoxEdit:
    box: Sequence[float] | None = effect.value.get("box")
    return BoxEdit(
        effect.kind,
        effect.place.frame_index,
        until_frame=effect.until_frame,
        box=None if box is None else cast("Box", tuple(box)),
    )


def _piece_rows(
    labelling_id: int,
    form: TrackedForm,
    spans: Iterable[Span],
    machine: dict[int, TrackedBox],
    visible: set[int],
    may_give: set[int],
) -> list[dict[str, Any]]:
    """The columns of each piece that has a box, but for its identity. Its best box is one of those in ``may_give``."""
    rows: list[dict[str, Any]] = []
    for span in spans:
        frames = sorted(frame for frame in visible if _within(span, frame))
        if not frames:
            continue
        scored = [
            (score, -frame) for frame in frames if frame in may_give and (score := machine[frame].score) is not None
        ]
        best_score, best_frame = max(scored, default=(None, -frames[0]))
        best = machine.get(-best_frame)
        rows.append(
            {
                "labelling_id": labelling_id,
                "track_id": span.track_id,
                "tracked_id": form.tracked_id,
                "camera_id": form.camera_id,
                "first_frame": frames[0],
                "last_frame": frames[-1],
                "observation_count": len(frames),
                "best_score": best_score,
                "best_frame": -best_frame,
                "class_id": form.class_id if best is None else best.class_id,
            }
        )
    return rows


def _within(span: Span, frame: int) -> bool:
    return span.start <= frame and (span.stop is None or frame < span.stop)
