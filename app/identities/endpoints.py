"""Identities of a drive."""

from fastapi import APIRouter

from app.db.session import ReadSession
from app.identities import service
from app.identities.schemas import Identity

router = APIRouter(prefix="/api/drives/{drive_id}", tags=["identities"])


@router.get("/identities")
def list_identities(drive_id: int, session: ReadSession) -> list[Identity]:
    """All identities of the drive, in order of id."""
    return service.list_identities(session, drive_id)
