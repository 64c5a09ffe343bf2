"""Identities of a drive."""

from fastapi import APIRouter, Request
from fastapi.responses import Response

from app.db.session import ReadSession
from app.identities import service
from app.identities.schemas import Identity
from app.tracks.answers import answer_for_labels

router = APIRouter(prefix="/api/drives/{drive_id}", tags=["identities"])


@router.get("/identities", response_model=list[Identity])
def list_identities(drive_id: int, request: Request, session: ReadSession) -> Response:
    """All identities of the drive, in order of id."""
    return answer_for_labels(request, session, drive_id, lambda: service.identities_json(session, drive_id))
