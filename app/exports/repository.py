"""SQL about exports."""

from sqlalchemy import select
from sqlalchemy.orm import Session

from app.exports.models import ExportRow
from app.jobs.models import JobRow


def insert(session: Session, export: ExportRow) -> ExportRow:
    session.add(export)
    session.flush()
    return export


def find(session: Session, export_id: int) -> tuple[ExportRow, JobRow] | None:
    """An export and the job that makes it."""
    query = select(ExportRow, JobRow).join(JobRow, JobRow.id == ExportRow.job_id).where(ExportRow.id == export_id)
    row = session.execute(query).one_or_none()
    return (row[0], row[1]) if row else None


def of_job(session: Session, job_id: int) -> ExportRow:
    """The export that a job makes, which must exist."""
    return session.scalars(select(ExportRow).where(ExportRow.job_id == job_id)).one()
