"""Rejecting the donor of an identity's label: another observation of it gives its label then."""

from typing import Any

from app.db.session import Session
from app.edits.schemas import DonorEdit
from app.edits.subjects import Subjects
from app.edits.types import Effect, EffectKind, Place
from app.errors import InvalidRequest
from app.identities.relabelling import Relabelling


def decide_donor(session: Session, subjects: Subjects, edit: DonorEdit) -> tuple[list[Effect], dict[str, Any]]:
    """The observation, or all of its track from the first frame to the last, is no donor.

    NotFound; InvalidRequest where a person gave the class, and where no other observation could give its label."""
    (identity,) = subjects.identities([edit.identity_id])
    (track,) = subjects.tracks([edit.track_id])
    if identity.class_by_person:
        raise InvalidRequest(
            f"A person gave object {identity.identity_id} its class, so it takes its label from no observation. Undo "
            "that first."
        )
    if track.identity_id != identity.identity_id:
        raise InvalidRequest(f"Track {track.track_id} is not of object {identity.identity_id} any more. Look again.")
    subjects.require_box(track, edit.frame_index)
    first, last = (track.first_frame, track.last_frame) if edit.whole_track else (edit.frame_index, edit.frame_index)
    effect = Effect(EffectKind.NO_DONOR, Place(track.tracked_id, first), until_frame=last)
    left = Relabelling(session, subjects.labelling.id, also_rejected=[effect])
    if left.donor([one.track_id for one in subjects.tracks_of([identity.identity_id])]) is None:
        raise InvalidRequest(
            f"Object {identity.identity_id} was detected in no other picture that may give it its label. Give it a "
            "class instead."
        )
    about: dict[str, Any] = {
        "identity_ids": [identity.identity_id],
        "track_ids": [track.track_id],
        "camera": subjects.camera_of(track),
    }
    return [effect], about if edit.whole_track else {**about, "frame_index": edit.frame_index}
