"""Drives: list, register, upload, look at, delete, label."""

from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, Query, Request

from app.db.session import ReadSession, WriteSession
from app.dependencies import AppSettings, AppStore
from app.drives import service, upload
from app.drives.schemas import Drive, DriveDetail, DriveRegistration, LabelRequest, Model
from app.jobs.schemas import Job

router = APIRouter(prefix="/api", tags=["drives"])


@router.get("/models")
def list_models(settings: AppSettings) -> list[Model]:
    """The detectors that a drive can be labelled with: pulled, shipped and added ones, and that of the settings."""
    return service.list_models(settings)


@router.get("/drives")
def list_drives(session: ReadSession) -> list[Drive]:
    """All drives, newest first."""
    return service.list_drives(session)


@router.post("/drives", status_code=HTTPStatus.CREATED)
def register_drive(registration: DriveRegistration, store: AppStore, settings: AppSettings) -> Drive:
    """Take a folder on the server's own disk as it lies there. One that is known already is answered as it is."""
    return service.register_drive(store, settings, registration)


@router.post(
    "/drives/upload",
    status_code=HTTPStatus.CREATED,
    openapi_extra={
        "requestBody": {
            "required": True,
            "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
        }
    },
)
async def upload_drive(
    request: Request,
    store: AppStore,
    settings: AppSettings,
    filename: Annotated[str, Query(min_length=1, max_length=255, description="Name of the archive.")],
) -> Drive:
    """Take a drive as a zip or tar archive, and queue labelling where a model suits it."""
    return await upload.receive_drive(request.stream(), request.headers, filename, store=store, settings=settings)


@router.get("/drives/{drive_id}")
def get_drive(drive_id: int, session: ReadSession) -> DriveDetail:
    """One drive in full."""
    return service.get_drive(session, drive_id)


@router.delete("/drives/{drive_id}", status_code=HTTPStatus.NO_CONTENT)
def delete_drive(drive_id: int, store: AppStore, settings: AppSettings) -> None:
    """Forget a drive; an uploaded copy is deleted, a registered folder never is."""
    service.delete_drive(store, settings, drive_id)


@router.post("/drives/{drive_id}/label", status_code=HTTPStatus.ACCEPTED)
def label_drive(drive_id: int, request: LabelRequest, session: WriteSession, settings: AppSettings) -> Job:
    """Queue labelling. A label job of the drive that is still waiting or running is answered instead of a second."""
    return service.queue_labelling(session, settings, drive_id, request.model)
