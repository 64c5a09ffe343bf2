"""Exports for the page: asking for one, looking at it, its file."""

from dataclasses import dataclass
from pathlib import Path

from app.db.session import Session
from app.drives.service import require_drive
from app.errors import Conflict, NotFound
from app.exports import repository
from app.exports.models import ExportRow
from app.exports.schemas import Export, ExportFormat, ExportRequest, ExportState
from app.jobs import repository as jobs_repository
from app.jobs.models import JobRow
from app.jobs.schemas import JobKind, JobState
from app.settings import Settings
from app.tracks import repository as tracks_repository
from labeler.export import find_exporter

_STATES = {
    JobState.QUEUED: ExportState.QUEUED,
    JobState.RUNNING: ExportState.RUNNING,
    JobState.DONE: ExportState.DONE,
    JobState.FAILED: ExportState.FAILED,
    JobState.CANCELLED: ExportState.FAILED,
}


@dataclass(frozen=True)
class ExportFile:
    """A finished dataset file."""

    path: Path
    media_type: str
    download_name: str


def create_export(session: Session, drive_id: int, request: ExportRequest) -> Export:
    """Queue an export of the drive's labels; Conflict before there are any."""
    drive = require_drive(session, drive_id)
    if tracks_repository.current_labelling(session, drive_id) is None:
        raise Conflict(f"Drive {drive.name} has no labels to export yet. Label it first.")
    job = jobs_repository.insert(session, drive_id=drive_id, kind=JobKind.EXPORT)
    export = ExportRow(drive_id=drive_id, job_id=job.id, format=request.format, min_score=request.min_score)
    return _to_export(repository.insert(session, export), job)


def get_export(session: Session, export_id: int) -> Export:
    return _to_export(*_require(session, export_id))


def export_file(session: Session, settings: Settings, export_id: int) -> ExportFile:
    """Where the finished file lies; Conflict before it is finished."""
    export, job = _require(session, export_id)
    if job.state != JobState.DONE or export.file_name is None:
        raise Conflict(f"Export {export_id} is {_to_export(export, job).state}, so it has no file.")
    path = settings.exports_folder / export.file_name
    if not path.is_file():
        raise NotFound(f"The file of export {export_id} is gone from {settings.exports_folder}. Export again.")
    return ExportFile(path, find_exporter(export.format).media_type, export.file_name)


def _require(session: Session, export_id: int) -> tuple[ExportRow, JobRow]:
    found = repository.find(session, export_id)
    if found is None:
        raise NotFound(f"There is no export {export_id}. It may have gone with its drive.")
    return found


def _to_export(export: ExportRow, job: JobRow) -> Export:
    state = _STATES[JobState(job.state)]
    error = "It was cancelled." if job.state == JobState.CANCELLED else job.error
    return Export(
        id=export.id,
        drive_id=export.drive_id,
        format=ExportFormat(export.format),
        state=state,
        label_count=export.label_count,
        size_bytes=export.size_bytes,
        error=error,
        job_id=export.job_id,
        file_url=f"/api/exports/{export.id}/file" if state is ExportState.DONE else None,
    )
