"""A drive's labels in numbers."""

from fastapi import APIRouter, Request
from fastapi.responses import Response
from pydantic_core import to_json

from app.db.session import ReadSession
from app.summary import service
from app.summary.schemas import LabelHistogram
from app.tracks.answers import answer_for_labels

router = APIRouter(prefix="/api/drives/{drive_id}", tags=["summary"])


@router.get("/histogram", response_model=LabelHistogram)
def get_histogram(drive_id: int, request: Request, session: ReadSession) -> Response:
    """How many labels there are, by class, source, score and distance: enough to try any threshold in the browser."""
    return answer_for_labels(request, session, drive_id, lambda: to_json(service.histogram(session, drive_id)))
