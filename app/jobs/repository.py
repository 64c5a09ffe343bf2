"""SQL about jobs."""

from collections.abc import Sequence
from datetime import datetime
from typing import Any

from sqlalchemy import case, func, or_, select, update
from sqlalchemy.orm import Session

from app.db.base import now
from app.jobs.models import JobRow

FINAL = ("done", "failed", "cancelled")


def insert(session: Session, *, drive_id: int, kind: str, model_path: str | None = None) -> JobRow:
    job = JobRow(drive_id=drive_id, kind=kind, state="queued", model_path=model_path)
    session.add(job)
    session.flush()
    return job


def find(session: Session, job_id: int) -> JobRow | None:
    return session.get(JobRow, job_id)


def list_of_drive(session: Session, drive_id: int) -> Sequence[JobRow]:
    """Newest first."""
    return session.scalars(select(JobRow).where(JobRow.drive_id == drive_id).order_by(JobRow.id.desc())).all()


def latest_label_jobs(session: Session, drive_ids: Sequence[int]) -> dict[int, JobRow]:
    """The newest label job of each drive that has one."""
    newest = (
        select(func.max(JobRow.id))
        .where(JobRow.kind == "label", JobRow.drive_id.in_(drive_ids))
        .group_by(JobRow.drive_id)
    )
    return {job.drive_id: job for job in session.scalars(select(JobRow).where(JobRow.id.in_(newest)))}


def claim(session: Session, *, worker: str, stale_before: datetime) -> JobRow | None:
    """Give the oldest waiting job, or one whose worker fell silent before ``stale_before``, to ``worker``."""
    free = (
        select(JobRow.id)
        .where(or_(JobRow.state == "queued", (JobRow.state == "running") & (JobRow.heartbeat_at < stale_before)))
        .order_by(JobRow.id)
        .limit(1)
        .with_for_update(skip_locked=True)
    )
    moment = now()
    return session.scalars(
        update(JobRow)
        .where(JobRow.id == free.scalar_subquery())
        .values(
            state="running",
            worker=worker,
            heartbeat_at=moment,
            started_at=func.coalesce(JobRow.started_at, moment),
            attempts=JobRow.attempts + 1,
        )
        .returning(JobRow),
        execution_options={"populate_existing": True},
    ).one_or_none()


def end_stale(session: Session, *, stale_before: datetime, max_attempts: int) -> None:
    """End jobs whose worker fell silent, where the job was to be cancelled or has killed too many workers."""
    stale = (JobRow.state == "running") & (JobRow.heartbeat_at < stale_before)
    session.execute(
        update(JobRow)
        .where(stale, or_(JobRow.cancel_requested, JobRow.attempts >= max_attempts))
        .values(
            state=case((JobRow.cancel_requested, "cancelled"), else_="failed"),
            error=case(
                (JobRow.cancel_requested, None),
                else_="Its worker died each time it was tried, perhaps for want of memory. Its log says more.",
            ),
            finished_at=now(),
            worker=None,
        )
    )


def report(session: Session, job_id: int, *, worker: str, values: dict[str, Any]) -> bool | None:
    """Write progress and a sign of life. Whether the job is to be cancelled; None where it isn't this worker's now."""
    return session.scalars(
        update(JobRow)
        .where(JobRow.id == job_id, JobRow.worker == worker, JobRow.state == "running")
        .values(heartbeat_at=now(), **values)
        .returning(JobRow.cancel_requested)
    ).one_or_none()


def finish(
    session: Session, job_id: int, *, worker: str, state: str, error: str | None = None, message: str | None = None
) -> None:
    """End a job that is still this worker's."""
    session.execute(
        update(JobRow)
        .where(JobRow.id == job_id, JobRow.worker == worker, JobRow.state == "running")
        .values(state=state, error=error, message=message, finished_at=now(), worker=None)
    )


def release(session: Session, job_id: int, *, worker: str) -> None:
    """Put a job back in the queue, as if this worker had never had it."""
    session.execute(
        update(JobRow)
        .where(JobRow.id == job_id, JobRow.worker == worker, JobRow.state == "running")
        .values(state="queued", worker=None, heartbeat_at=None, attempts=JobRow.attempts - 1)
    )


def active_label_job(session: Session, drive_id: int) -> JobRow | None:
    """The label job of the drive that waits or runs and is not being cancelled."""
    return session.scalars(
        select(JobRow)
        .where(
            JobRow.drive_id == drive_id,
            JobRow.kind == "label",
            JobRow.state.in_(("queued", "running")),
            ~JobRow.cancel_requested,
        )
        .order_by(JobRow.id.desc())
        .limit(1)
    ).one_or_none()
