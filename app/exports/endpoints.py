"""Exports: ask for one, look, download."""

from http import HTTPStatus

from fastapi import APIRouter
from fastapi.responses import FileResponse

from app.db.session import ReadSession, WriteSession
from app.dependencies import AppSettings
from app.exports import service
from app.exports.schemas import Export, ExportRequest

router = APIRouter(prefix="/api", tags=["exports"])


@router.post("/drives/{drive_id}/exports", status_code=HTTPStatus.ACCEPTED)
def create_export(drive_id: int, request: ExportRequest, session: WriteSession) -> Export:
    """Queue writing the drive's labels in a dataset format."""
    return service.create_export(session, drive_id, request)


@router.get("/exports/{export_id}")
def get_export(export_id: int, session: ReadSession) -> Export:
    return service.get_export(session, export_id)


@router.get(
    "/exports/{export_id}/file",
    response_class=FileResponse,
    responses={200: {"content": {"application/json": {}}, "description": "The dataset file."}},
)
def download_export(export_id: int, session: ReadSession, settings: AppSettings) -> FileResponse:
    """The finished file as a download."""
    file = service.export_file(session, settings, export_id)
    return FileResponse(file.path, media_type=file.media_type, filename=file.download_name)
