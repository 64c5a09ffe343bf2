"""How far labels can be believed."""

from fastapi import APIRouter

from app.audit import service
from app.audit.schemas import Audit
from app.db.session import ReadSession

router = APIRouter(prefix="/api/drives/{drive_id}", tags=["summary"])


@router.get("/audit")
def get_audit(drive_id: int, session: ReadSession) -> Audit | None:
    """The last `hindsight audit` of the labels as they are; null where there is none."""
    return service.last_audit(session, drive_id)
