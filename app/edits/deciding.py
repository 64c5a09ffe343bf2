"""From what a person asks for to its effects: one function for each kind of edit.

Nothing is written here. An edit that can't be is refused with the reason (NotFound, InvalidRequest, CannotLink,
ClassesDiffer).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from app.db.session import Session
from app.edits import repository
from app.edits.anchors import TrackIds
from app.edits.donors import decide_donor
from app.edits.drawing import decide_box, decide_interpolation
from app.edits.pairs import pairs
from app.edits.pieces import Pieces
from app.edits.schemas import (
    AnyEdit,
    BoxEdit,
    ClassEdit,
    CommentEdit,
    DeleteEdit,
    DonorEdit,
    InterpolateEdit,
    JoinEdit,
    MarkEdit,
    SplitEdit,
    SwapEdit,
)
from app.edits.subjects import Subjects
from app.edits.types import Effect, EffectKind, Place
from app.errors import InvalidRequest
from app.identities.classes import require_one_class
from app.identities.conflicts import require_one_object
from app.tracks.models import TrackRow


@dataclass(frozen=True)
class Decided:
    """The effects of an edit, and what its log says it is about."""

    effects: list[Effect]
    about: dict[str, Any] = field(default_factory=dict[str, Any])


def decide(session: Session, subjects: Subjects, edit: AnyEdit) -> Decided:
    """The effects of an edit of any kind."""
    match edit:
        case ClassEdit():
            return _decide_class(subjects, edit)
        case SplitEdit():
            return _decide_split(session, subjects, edit)
        case JoinEdit():
            return _decide_join(session, subjects, edit)
        case SwapEdit():
            return _decide_swap(session, subjects, edit)
        case DeleteEdit():
            return _decide_delete(session, subjects, edit)
        case BoxEdit():
            effects, about = decide_box(session, subjects, edit)
            return Decided(effects, about)
        case InterpolateEdit():
            effects, about = decide_interpolation(session, subjects, edit)
            return Decided(effects, about)
        case DonorEdit():
            effects, about = decide_donor(session, subjects, edit)
            return Decided(effects, about)
        case MarkEdit():
            return _say(subjects, edit.identity_ids, EffectKind.MARK, {"mark": str(edit.mark)})
        case CommentEdit():
            decided = _say(subjects, edit.identity_ids, EffectKind.COMMENT, {})
            decided.about["text"] = edit.text
            return decided


def _decide_class(subjects: Subjects, edit: ClassEdit) -> Decided:
    subjects.require_class(edit.class_name)
    return _say(subjects, edit.identity_ids, EffectKind.CLASS, {"class_name": edit.class_name})


def _say(subjects: Subjects, identity_ids: Iterable[int], kind: EffectKind, value: dict[str, Any]) -> Decided:
    """Something about objects, said at the best observation of each."""
    identities = subjects.identities(identity_ids)
    effects = [Effect(kind, subjects.best_place(identity.identity_id), value=value) for identity in identities]
    return Decided(effects, {"identity_ids": [identity.identity_id for identity in identities], **value})


def _decide_split(session: Session, subjects: Subjects, edit: SplitEdit) -> Decided:
    ids = TrackIds(session, subjects.labelling.id)
    effects: list[Effect] = []
    tracks = subjects.tracks(edit.track_ids)
    for track in tracks:
        if not track.first_frame < edit.frame_index <= track.last_frame:
            raise InvalidRequest(
                f"Track {track.track_id} can't be split at frame {edit.frame_index}: it goes from frame "
                f"{track.first_frame} to {track.last_frame}, and each part needs a frame. Choose one after the first."
            )
        effects += _split(ids, track, edit.frame_index)
    return Decided(
        effects,
        {
            "identity_ids": sorted({track.identity_id for track in tracks}),
            "track_ids": [track.track_id for track in tracks],
            "frame_index": edit.frame_index,
        },
    )


def _split(ids: TrackIds, track: TrackRow, frame_index: int) -> list[Effect]:
    before, after = Place(track.tracked_id, frame_index - 1), Place(track.tracked_id, frame_index)
    return [
        Effect(EffectKind.CUT, after, made_track_id=ids.of_cut(after)),
        Effect(EffectKind.APART, before, other=after),
    ]


def _decide_join(session: Session, subjects: Subjects, edit: JoinEdit) -> Decided:
    identities = subjects.identities(edit.identity_ids)
    if len(identities) < 2:
        raise InvalidRequest("Only one object is named, and it is one already. Select two or more.")
    donors = [identity.donor_track_id for identity in identities]
    require_one_class(session, subjects.labelling.id, donors)
    group = [_whole(track) for track in subjects.tracks_of(edit.identity_ids)]
    lifted = _lift(session, subjects, [group])
    require_one_object(session, subjects.labelling.id, donors, lifted=lifted)
    places = [subjects.best_place(identity.identity_id) for identity in identities]
    effects = [*lifted, *(Effect(EffectKind.SAME, places[0], other=other) for other in places[1:])]
    return Decided(effects, {"identity_ids": [identity.identity_id for identity in identities]})


def _decide_swap(session: Session, subjects: Subjects, edit: SwapEdit) -> Decided:
    identities = subjects.identities(edit.identity_ids)
    if len(identities) < 2:
        raise InvalidRequest("An object can't be swapped with itself. Select two.")
    ids = TrackIds(session, subjects.labelling.id)
    effects: list[Effect] = []
    before: list[list[Place]] = []
    after: list[list[Place]] = []
    for identity in identities:
        tracks = subjects.tracks_of([identity.identity_id])
        early, late = [], []
        for track in tracks:
            if track.first_frame < edit.frame_index <= track.last_frame:
                place = Place(track.tracked_id, edit.frame_index)
                effects.append(Effect(EffectKind.CUT, place, made_track_id=ids.of_cut(place)))
                early.append(Place(track.tracked_id, edit.frame_index - 1))
                late.append(place)
            else:
                (early if track.last_frame < edit.frame_index else late).append(_whole(track))
        before.append(early)
        after.append(late)
    if not any(after) or not any(before):
        where = "after" if not any(after) else "before"
        raise InvalidRequest(
            f"Neither of the two objects is seen {where} frame {edit.frame_index}, so there is nothing to swap there."
        )
    groups = [before[0] + after[1], before[1] + after[0]]
    cuts = [effect for effect in effects if effect.kind is EffectKind.CUT]
    effects += _lift(session, subjects, groups, cuts=cuts)
    for group in groups:
        effects += [Effect(EffectKind.SAME, one, other=other) for one, other in pairwise(group)]
    if groups[0] and groups[1]:
        effects.append(Effect(EffectKind.APART, groups[0][0], other=groups[1][0]))
    return Decided(
        effects,
        {"identity_ids": [identity.identity_id for identity in identities], "frame_index": edit.frame_index},
    )


def _whole(track: TrackRow) -> Place:
    return Place(track.tracked_id, track.first_frame)


def _lift(
    session: Session, subjects: Subjects, groups: Sequence[Sequence[Place]], *, cuts: Sequence[Effect] = ()
) -> list[Effect]:
    """Take back what people said before that contradicts these groups: one object each, and different ones."""
    pieces = repository.pieces(session, subjects.labelling.id).with_cuts(
        (cut.place, cut.made_track_id) for cut in cuts if cut.made_track_id is not None
    )
    group_of = {pieces.track_at(place): number for number, group in enumerate(groups) for place in group}
    lifted: list[Effect] = []
    for pair in pairs(session, subjects.labelling.id, pieces):
        group_a, group_b = group_of.get(pair.track_a), group_of.get(pair.track_b)
        if group_a is None or group_b is None:
            continue
        if (group_a == group_b) is (pair.kind is EffectKind.APART):
            lifted.append(Effect(EffectKind.OPEN, pair.place, other=pair.other))
    return lifted


def _decide_delete(session: Session, subjects: Subjects, edit: DeleteEdit) -> Decided:
    identities = subjects.identities(edit.identity_ids)
    tracks = subjects.tracks(edit.track_ids)
    pieces = repository.pieces(session, subjects.labelling.id)
    whole = {track.track_id: track for track in [*subjects.tracks_of(edit.identity_ids), *tracks]}
    effects = [_hide(subjects, pieces, track) for track in whole.values()]
    touched = {track.identity_id for track in whole.values()}
    for one in edit.observations:
        (track,) = subjects.tracks([one.track_id])
        subjects.require_box(track, one.frame_index)
        touched.add(track.identity_id)
        place = Place(track.tracked_id, one.frame_index)
        camera = {"camera": subjects.camera_of(track)}
        effects.append(Effect(EffectKind.HIDE, place, until_frame=one.frame_index, value=camera))
    about: dict[str, Any] = {"identity_ids": sorted(touched)}
    if not identities:
        about["track_ids"] = sorted(
            {*(track.track_id for track in tracks), *(one.track_id for one in edit.observations)}
        )
    if edit.observations:
        about["frame_index"] = edit.observations[0].frame_index
    return Decided(effects, about)


def _hide(subjects: Subjects, pieces: Pieces, track: TrackRow) -> Effect:
    """All of a track; of one that was split, its piece."""
    span = next(span for span in pieces.spans(track.tracked_id) if span.track_id == track.track_id)
    return Effect(
        EffectKind.HIDE,
        Place(track.tracked_id, span.start),
        until_frame=None if span.stop is None else span.stop - 1,
        value={"camera": subjects.camera_of(track)},
    )
