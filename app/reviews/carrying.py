"""Carrying decisions over to another labelling of the same drive.

A decision names each of its two tracks by one of its boxes. In the new labelling the track of that camera whose box in
that frame overlaps it most, and by at least half (IoU), is the same object. A decision whose tracks are not both found,
or that can't hold together with others, is kept: it may fit the labelling after.
"""

from dataclasses import dataclass

import numpy as np

from app.db.session import Session
from app.edits import repository as edits_repository
from app.edits.carrying import carry_edits
from app.identities.linking import relink
from app.merges import repository as merges_repository
from app.merges.models import MergeRow
from app.reviews import repository
from app.reviews.models import ReviewRow
from app.reviews.schemas import MergeEvidence, ReviewAction, TrackAnchor
from app.tracks import repository as tracks_repository
from labeler.geometry.boxes_2d import iou_matrix

MIN_IOU = 0.5
STATE_AFTER = {
    ReviewAction.ACCEPT: "accepted",
    ReviewAction.REJECT: "rejected",
    ReviewAction.UNSURE: "unsure",
}


@dataclass(frozen=True)
class CarriedOver:
    """How many decisions hold in the new labelling, and how many could not be placed."""

    held: int
    lost: int


def carry_over(session: Session, drive_id: int, labelling_id: int) -> CarriedOver:
    """Let the decisions of people hold in a labelling whose rows are all there."""
    edits = carry_edits(session, tracks_repository.find_labelling(session, labelling_id))
    camera_ids = {name: camera_id for camera_id, name in tracks_repository.camera_names(session, drive_id).items()}
    lost = edits.lost
    decided: dict[int, MergeRow] = {}
    subjects: dict[int, int] = {}
    for review in repository.latest_of_subjects(session, drive_id):
        assert review.subject_id is not None
        pair = _find_pair(session, labelling_id, review, camera_ids)
        merge = _merge_for(session, labelling_id, review, pair) if pair else None
        if pair is None or (pair[0] == pair[1] and review.action == ReviewAction.REJECT):
            lost += review.action != ReviewAction.UNDO
        if merge is None:
            repository.attach(session, review.subject_id, merge_id=None)
            continue
        subjects[merge.id] = subjects.get(merge.id, review.subject_id)
        repository.attach(session, review.subject_id, merge_id=merge.id, to_subject=subjects[merge.id])
        decide_merge(merge, ReviewAction(review.action))
        decided[merge.id] = merge
    refused = _settle(session, labelling_id, decided, edits.track_ids)
    lost += refused
    held = sum(merge.decided_by == "person" for merge in decided.values())
    return CarriedOver(held=held + edits.held, lost=lost)


def _find_pair(
    session: Session, labelling_id: int, review: ReviewRow, camera_ids: dict[str, int]
) -> tuple[int, int] | None:
    """The two tracks of a decision, the smaller id first; they may have become one track."""
    found = [
        _find_track(session, labelling_id, TrackAnchor.model_validate(anchor), camera_ids)
        for anchor in (review.anchor_a, review.anchor_b)
    ]
    a, b = found
    return (min(a, b), max(a, b)) if a is not None and b is not None else None


def _find_track(session: Session, labelling_id: int, anchor: TrackAnchor, camera_ids: dict[str, int]) -> int | None:
    camera_id = camera_ids.get(anchor.camera)
    if camera_id is None:
        return None
    boxes = tracks_repository.boxes_in_image(session, labelling_id, camera_id, anchor.frame_index)
    if not boxes:
        return None
    overlaps = iou_matrix(np.array([anchor.box]), np.array([box[1:] for box in boxes], np.float64))[0]
    best = int(np.argmax(overlaps))
    return boxes[best].track_id if overlaps[best] >= MIN_IOU else None


def _merge_for(session: Session, labelling_id: int, review: ReviewRow, pair: tuple[int, int]) -> MergeRow | None:
    """The merge that a decision is about; where the machine has not proposed it this time, it is made."""
    track_a, track_b = pair
    if track_a == track_b:
        return None
    known = merges_repository.find_pair(session, labelling_id, track_a, track_b)
    if known is not None or review.action == ReviewAction.UNDO:
        return known
    evidence = MergeEvidence.model_validate(review.evidence)
    pieces = {track.track_id: track for track in tracks_repository.tracks_with(session, labelling_id, pair)}
    return merges_repository.add_merge(
        session,
        MergeRow(
            labelling_id=labelling_id,
            track_a=track_a,
            track_b=track_b,
            tracked_a=pieces[track_a].tracked_id,
            tracked_b=pieces[track_b].tracked_id,
            frame_a=pieces[track_a].best_frame,
            frame_b=pieces[track_b].best_frame,
            machine_state="proposed",
            state="proposed",
            decided_by="machine",
            **evidence.model_dump(),
        ),
    )


def decide_merge(merge: MergeRow, action: ReviewAction) -> None:
    """Let a decision about a merge be what holds. Identities are to be linked anew after that."""
    if action is ReviewAction.UNDO:
        merge.state, merge.decided_by = merge.machine_state, "machine"
    else:
        merge.state, merge.decided_by = STATE_AFTER[action], "person"


def _settle(session: Session, labelling_id: int, decided: dict[int, MergeRow], edited_tracks: frozenset[int]) -> int:
    """Make identities fit; decisions that can't hold together go back to the machine's word. How many do."""
    tracks = {track for merge in decided.values() for track in (merge.track_a, merge.track_b) if track is not None}
    tracks |= edited_tracks
    if not tracks:
        return 0
    refused = relink(session, labelling_id, tracks).refused
    for one in refused:
        if one.merge_id is not None:
            merge = decided[one.merge_id]
            merge.state, merge.decided_by = merge.machine_state, "machine"
    edits_repository.set_active(session, [one.effect_id for one in refused if one.effect_id is not None], active=False)
    if refused:
        relink(session, labelling_id, tracks)
    return len(refused)
