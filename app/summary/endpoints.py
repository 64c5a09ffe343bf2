"""A drive's labels in numbers."""

from fastapi import APIRouter

from app.db.session import ReadSession
from app.summary import service
from app.summary.schemas import LabelHistogram

router = APIRouter(prefix="/api/drives/{drive_id}", tags=["summary"])


@router.get("/histogram")
def get_histogram(drive_id: int, session: ReadSession) -> LabelHistogram:
    """How many labels there are, by class, source, score and distance: enough to try any threshold in the browser."""
    return service.histogram(session, drive_id)
