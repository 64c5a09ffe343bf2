"""Merges: list, accept, reject, undo."""

from typing import Annotated

from fastapi import APIRouter, Query

from app.db.session import ReadSession, WriteSession
from app.dependencies import AppSettings
from app.merges import service
from app.merges.schemas import Merge, MergeChange, MergeState

router = APIRouter(prefix="/api", tags=["merges"])


@router.get("/drives/{drive_id}/merges")
def list_merges(
    drive_id: int,
    session: ReadSession,
    state: Annotated[MergeState | None, Query(description="Only merges in this state.")] = None,
) -> list[Merge]:
    """Merges of the drive by descending score."""
    return service.list_merges(session, drive_id, state)


@router.post("/merges/{merge_id}/accept")
def accept_merge(merge_id: int, session: WriteSession, settings: AppSettings) -> MergeChange:
    """Say that the two tracks are one object; 409 where that can't be."""
    return service.accept_merge(session, merge_id, reviewer=settings.reviewer)


@router.post("/merges/{merge_id}/reject")
def reject_merge(merge_id: int, session: WriteSession, settings: AppSettings) -> MergeChange:
    """Say that the two tracks are two objects."""
    return service.reject_merge(session, merge_id, reviewer=settings.reviewer)


@router.post("/merges/{merge_id}/undo")
def undo_merge(merge_id: int, session: WriteSession, settings: AppSettings) -> MergeChange:
    """Take back what a person said; what the machine said holds again."""
    return service.undo_merge(session, merge_id, reviewer=settings.reviewer)
