"""Letting a labelling follow effects that came or went; only what they touch is looked at."""

from collections.abc import Iterable
from dataclasses import replace

from app.db.session import Session
from app.edits import repository
from app.edits import track_repository as tracks
from app.edits.reshaping import TrackedForm, place_merges, reshape
from app.edits.types import SHAPING, Effect
from app.identities.linking import Relinked, relink
from app.tracks import repository as tracks_repository
from app.tracks.models import LabellingRow


def apply(session: Session, labelling: LabellingRow, effects: Iterable[Effect]) -> Relinked:
    """Make tracks, identities and labels fit the effects that hold now; ``effects`` are those that came or went."""
    effects = list(effects)
    named = {place.tracked_id for effect in effects for place in (effect.place, effect.other) if place is not None}
    changed = tracks.pieces_of(session, labelling.id, named)
    before = {track.track_id for track in changed}
    gone = {track.identity_id for track in changed}
    members = {track.track_id for track in tracks_repository.tracks_of_identities(session, labelling.id, gone)}
    shaped = sorted({effect.place.tracked_id for effect in effects if effect.kind in SHAPING})
    if shaped:
        reshape_tracks(session, labelling, shaped)
    after = {track.track_id for track in tracks.pieces_of(session, labelling.id, named)}
    members |= after
    there = tracks_repository.tracks_with(session, labelling.id, members)
    relinked = relink(session, labelling.id, [track.track_id for track in there], gone_identities=gone)
    return replace(relinked, changed_tracks=relinked.changed_tracks | before | after) if shaped else relinked


def reshape_tracks(session: Session, labelling: LabellingRow, tracked_ids: Iterable[int]) -> None:
    """Give tracks as tracked, and the merges about them, the form that the effects ask for."""
    ids = list(tracked_ids)
    pieces = repository.pieces(session, labelling.id)
    camera_ids = {name: key for key, name in tracks_repository.camera_names(session, labelling.drive_id).items()}
    for tracked_id in ids:
        reshape(session, labelling, _form_of(session, labelling, tracked_id, camera_ids), pieces)
    session.expire_all()
    place_merges(session, labelling.id, ids, pieces)


def _form_of(session: Session, labelling: LabellingRow, tracked_id: int, camera_ids: dict[str, int]) -> TrackedForm:
    found = tracks.pieces_of(session, labelling.id, [tracked_id])
    if found:
        camera_id = found[0].camera_id
    else:  # a track that a person made, or deleted as a whole
        camera = repository.camera_of(session, labelling.id, tracked_id)
        assert camera is not None
        camera_id = camera_ids[camera]
    class_name = repository.class_of_new(session, labelling.id, tracked_id)
    if class_name is not None:
        names = labelling.class_names
        return TrackedForm(tracked_id, camera_id, names.index(class_name) if class_name in names else 0)
    machine = [box for box in tracks.boxes_of(session, labelling.id, tracked_id) if not box.drawn]
    best = max(machine, key=lambda box: (box.score is not None, box.score or 0.0, -box.frame_index))
    return TrackedForm(tracked_id, camera_id, best.class_id)
