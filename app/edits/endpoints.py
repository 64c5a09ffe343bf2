"""Corrections, undo and redo, the log of all decisions, comments; and word of what others change."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import Response, StreamingResponse

from app.changes.answers import change_answer
from app.changes.schemas import EditChange
from app.db.session import ReadSession, WriteSession
from app.dependencies import AppSettings, AppStore, Reviewer
from app.edits import events, service, undoing
from app.edits.schemas import Comment, EditPage, EditRequest, UndoRequest

router = APIRouter(prefix="/api/drives/{drive_id}", tags=["edits"])


@router.post("/edits", response_model=EditChange)
def make_edit(drive_id: int, request: EditRequest, session: WriteSession, reviewer: Reviewer) -> Response:
    """Correct labels. 409 where the correction can't be, or where the same objects have changed since `revision`."""
    return change_answer(
        service.make_edit(session, drive_id, request.edit, seen_revision=request.revision, reviewer=reviewer)
    )


@router.get("/edits")
def list_edits(
    drive_id: int,
    session: ReadSession,
    reviewer: Reviewer,
    before: Annotated[int | None, Query(description="Only decisions before this one.")] = None,
    limit: Annotated[int, Query(ge=1, le=500)] = service.PAGE,
) -> EditPage:
    """The log: all decisions about the drive, newest first."""
    return service.list_edits(session, drive_id, before=before, limit=limit, reviewer=reviewer)


@router.post("/undo", response_model=EditChange)
def undo_edit(drive_id: int, request: UndoRequest, session: WriteSession, reviewer: Reviewer) -> Response:
    """Take back the reviewer's latest decision, or the named one."""
    return change_answer(
        undoing.undo(session, drive_id, request.edit_id, seen_revision=request.revision, reviewer=reviewer)
    )


@router.post("/redo", response_model=EditChange)
def redo_edit(drive_id: int, request: UndoRequest, session: WriteSession, reviewer: Reviewer) -> Response:
    """Make the decision again that the reviewer undid last, or the named one."""
    return change_answer(
        undoing.redo(session, drive_id, request.edit_id, seen_revision=request.revision, reviewer=reviewer)
    )


@router.get("/comments")
def list_comments(
    drive_id: int,
    session: ReadSession,
    identity_id: Annotated[int | None, Query(description="Only comments on this object.")] = None,
) -> list[Comment]:
    """Comments on the drive's objects, the oldest first."""
    return service.list_comments(session, drive_id, identity_id)


@router.get(
    "/events",
    response_class=StreamingResponse,
    responses={
        200: {"content": {"text/event-stream": {}}, "description": "`event: revision` with a DriveRevision as data."}
    },
)
async def follow_drive(drive_id: int, request: Request, store: AppStore, settings: AppSettings) -> StreamingResponse:
    """Server-sent events: the drive's revision, whenever its labels have changed."""
    return await events.follow(request, store, drive_id, poll_seconds=settings.job_poll_seconds)
