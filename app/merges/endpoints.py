"""Merges: list, look at, accept, reject, leave open, undo."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import Response

from app.changes.answers import change_answer
from app.changes.schemas import MergeChange
from app.db.session import ReadSession, WriteSession
from app.dependencies import Reviewer
from app.merges import looks, service
from app.merges.schemas import Merge, MergeDecision, MergeLooks, MergeState
from app.tracks.answers import answer_for_labels

router = APIRouter(prefix="/api", tags=["merges"])
NOTHING_READ = MergeDecision()


@router.get("/drives/{drive_id}/merges", response_model=list[Merge])
def list_merges(
    drive_id: int,
    request: Request,
    session: ReadSession,
    state: Annotated[MergeState | None, Query(description="Only merges in this state.")] = None,
) -> Response:
    """Merges of the drive by descending score."""
    return answer_for_labels(request, session, drive_id, lambda: service.merges_json(session, drive_id, state))


@router.get("/merges/{merge_id}/looks")
def get_merge_looks(merge_id: int, session: ReadSession) -> MergeLooks:
    """What there is to see of a merge: looks at both tracks, alone and at the same moment, and their ways."""
    return looks.looks_of_merge(session, merge_id)


@router.post("/merges/{merge_id}/accept", response_model=MergeChange)
def accept_merge(
    merge_id: int, session: WriteSession, reviewer: Reviewer, asked: MergeDecision = NOTHING_READ
) -> Response:
    """Say that the two tracks are one object; 409 where that can't be, or where they have changed since `revision`."""
    return change_answer(service.accept_merge(session, merge_id, seen_revision=asked.revision, reviewer=reviewer))


@router.post("/merges/{merge_id}/reject", response_model=MergeChange)
def reject_merge(
    merge_id: int, session: WriteSession, reviewer: Reviewer, asked: MergeDecision = NOTHING_READ
) -> Response:
    """Say that the two tracks are two objects."""
    return change_answer(service.reject_merge(session, merge_id, seen_revision=asked.revision, reviewer=reviewer))


@router.post("/merges/{merge_id}/unsure", response_model=MergeChange)
def leave_merge_open(
    merge_id: int, session: WriteSession, reviewer: Reviewer, asked: MergeDecision = NOTHING_READ
) -> Response:
    """Say that it can't be told: the tracks stay apart, and the merge leaves the queue until it is undone."""
    return change_answer(service.leave_merge_open(session, merge_id, seen_revision=asked.revision, reviewer=reviewer))


@router.post("/merges/{merge_id}/undo", response_model=MergeChange)
def undo_merge(
    merge_id: int, session: WriteSession, reviewer: Reviewer, asked: MergeDecision = NOTHING_READ
) -> Response:
    """Take back what a person said; what the machine said holds again."""
    return change_answer(service.undo_merge(session, merge_id, seen_revision=asked.revision, reviewer=reviewer))
