"""Asking for long work, looking at it, stopping it. The work itself is done by :mod:`app.jobs.worker`."""

from app.db.base import now
from app.db.session import Session
from app.drives import repository as drives_repository
from app.errors import NotFound
from app.jobs import repository
from app.jobs.models import JobRow
from app.jobs.schemas import Job, JobKind, JobState


def to_job(row: JobRow) -> Job:
    return Job.model_validate(row)


def list_jobs(session: Session, drive_id: int) -> list[Job]:
    """Jobs of a drive, newest first."""
    if drives_repository.find(session, drive_id) is None:
        raise NotFound(f"There is no drive {drive_id}. It may have been deleted.")
    return [to_job(row) for row in repository.list_of_drive(session, drive_id)]


def get_job(session: Session, job_id: int) -> Job:
    return to_job(_require(session, job_id))


def queue_label_job(session: Session, drive_id: int, *, model_path: str) -> Job:
    """Queue labelling of a drive; one that waits or runs already is answered instead."""
    active = repository.active_label_job(session, drive_id)
    return to_job(active or repository.insert(session, drive_id=drive_id, kind=JobKind.LABEL, model_path=model_path))


def cancel_job(session: Session, job_id: int) -> Job:
    """A waiting job ends at once; a running one is asked to; an ended one stays as it is."""
    row = _require(session, job_id)
    state = JobState(row.state)
    if state is JobState.QUEUED:
        row.state = JobState.CANCELLED
        row.finished_at = now()
    if not state.is_final:
        row.cancel_requested = True
    return to_job(row)


def _require(session: Session, job_id: int) -> JobRow:
    row = repository.find(session, job_id)
    if row is None:
        raise NotFound(f"There is no job {job_id}. It may have gone with its drive.")
    return row
