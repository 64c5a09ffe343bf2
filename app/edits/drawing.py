"""Boxes that people draw: which track they belong to, and which frames between get boxes too."""

from typing import Any

from app.db.session import Session
from app.drives.models import CameraRow
from app.edits import repository, track_repository
from app.edits.anchors import TrackIds
from app.edits.schemas import BoxEdit, InterpolateEdit
from app.edits.subjects import Subjects
from app.edits.track_repository import TrackedBox
from app.edits.types import Box, Effect, EffectKind, Place
from app.errors import InvalidRequest
from app.identities.models import IdentityRow
from app.tracks.models import TrackRow

SMALLEST_PX = 2.0
_Decided = tuple[list[Effect], dict[str, Any]]


def decide_box(session: Session, subjects: Subjects, edit: BoxEdit) -> _Decided:
    """A box of a track; of an identity's nearest track in the camera, or a new one; or of a new object."""
    camera = subjects.camera(edit.camera)
    box = _usable(edit.box, camera)
    if not track_repository.image_frames(session, subjects.drive.id, camera.id, edit.frame_index, edit.frame_index):
        raise InvalidRequest(f"Camera {camera.name} has no image in frame {edit.frame_index}, so nothing can be drawn.")
    about = {"camera": camera.name, "frame_index": edit.frame_index}
    track, identity = _track_for(session, subjects, edit, camera)
    if track is not None:
        place = Place(track.tracked_id, edit.frame_index)
        effects = [Effect(EffectKind.BOX, place, value={"box": list(box)})]
        if edit.interpolate:
            effects += _fill_gap(session, subjects, track, edit.frame_index)
        return effects, {**about, "identity_ids": [track.identity_id], "track_ids": [track.track_id]}
    class_name = subjects.labelling.class_names[identity.class_id] if identity is not None else edit.class_name
    if class_name is None:
        raise InvalidRequest("The box is of no known object, so it needs a class: name one, or select an object.")
    subjects.require_class(class_name)
    tracked_id = TrackIds(session, subjects.labelling.id).next()
    place = Place(tracked_id, edit.frame_index)
    effects = [
        Effect(EffectKind.NEW, place, value={"camera": camera.name, "class_name": class_name}),
        Effect(EffectKind.BOX, place, value={"box": list(box)}),
    ]
    if identity is None:
        effects.append(Effect(EffectKind.CLASS, place, value={"class_name": class_name}))
        return effects, {**about, "identity_ids": [], "track_ids": [tracked_id], "class_name": class_name}
    effects.append(Effect(EffectKind.SAME, subjects.best_place(identity.identity_id), other=place))
    return effects, {**about, "identity_ids": [identity.identity_id], "track_ids": [tracked_id]}


def decide_interpolation(session: Session, subjects: Subjects, edit: InterpolateEdit) -> _Decided:
    """Straight ways between two boxes of a track."""
    (track,) = subjects.tracks([edit.track_id])
    if edit.last_frame - edit.first_frame < 2:
        raise InvalidRequest(f"There is no frame between {edit.first_frame} and {edit.last_frame}.")
    for frame in (edit.first_frame, edit.last_frame):
        subjects.require_box(track, frame)
    effect = Effect(EffectKind.FILL, Place(track.tracked_id, edit.first_frame), until_frame=edit.last_frame)
    about = {
        "identity_ids": [track.identity_id],
        "track_ids": [track.track_id],
        "camera": subjects.camera_of(track),
        "frame_index": edit.first_frame,
        "until_frame": edit.last_frame,
    }
    return [effect], about


def _usable(box: Box, camera: CameraRow) -> Box:
    """The box within the image; InvalidRequest where nothing is left of it."""
    x1, x2 = (min(max(x, 0.0), float(camera.width_px)) for x in (box[0], box[2]))
    y1, y2 = (min(max(y, 0.0), float(camera.height_px)) for y in (box[1], box[3]))
    if not (x2 - x1 >= SMALLEST_PX and y2 - y1 >= SMALLEST_PX):  # NaN is refused too
        raise InvalidRequest(
            f"The box {box} is too small in an image of {camera.width_px} x {camera.height_px} pixels: it needs "
            f"{SMALLEST_PX:.0f} in each direction, with x1 < x2 and y1 < y2."
        )
    return (round(x1, 2), round(y1, 2), round(x2, 2), round(y2, 2))


def _track_for(
    session: Session, subjects: Subjects, edit: BoxEdit, camera: CameraRow
) -> tuple[TrackRow | None, IdentityRow | None]:
    """The track that the box belongs to, and the identity; None where a track has to be made, or an object."""
    identity_id, asked = edit.identity_id, edit.track_id
    if asked is not None:
        (track,) = subjects.tracks([asked])
        if track.camera_id != camera.id:
            raise InvalidRequest(f"Track {asked} is in camera {subjects.camera_of(track)}, not {camera.name}.")
        identity_id = track.identity_id
    if identity_id is None:
        return None, None
    pieces = repository.pieces(session, subjects.labelling.id)
    here = [
        track
        for track in subjects.tracks_of([identity_id])
        if track.camera_id == camera.id and pieces.track_at(Place(track.tracked_id, edit.frame_index)) == track.track_id
    ]

    def rank(track: TrackRow) -> tuple[bool, bool, int]:
        distance = max(track.first_frame - edit.frame_index, edit.frame_index - track.last_frame, 0)
        return (not subjects.has_box(track, edit.frame_index), track.track_id != asked, distance)

    return min(here, key=rank, default=None), subjects.identities([identity_id])[0]


def _fill_gap(session: Session, subjects: Subjects, track: TrackRow, frame_index: int) -> list[Effect]:
    """Fill the frames without a box between a drawn one and the next ones, where a person drew these too."""
    boxes = track_repository.boxes_of(session, subjects.labelling.id, track.tracked_id)
    known = [box for box in boxes if box.track_id == track.track_id]
    before = max((box for box in known if box.frame_index < frame_index), key=_frame, default=None)
    after = min((box for box in known if box.frame_index > frame_index), key=_frame, default=None)
    effects: list[Effect] = []
    if before is not None and before.drawn and frame_index - before.frame_index > 1:
        place = Place(track.tracked_id, before.frame_index)
        effects.append(Effect(EffectKind.FILL, place, until_frame=frame_index))
    if after is not None and after.drawn and after.frame_index - frame_index > 1:
        place = Place(track.tracked_id, frame_index)
        effects.append(Effect(EffectKind.FILL, place, until_frame=after.frame_index))
    return effects


def _frame(box: TrackedBox) -> int:
    return box.frame_index
