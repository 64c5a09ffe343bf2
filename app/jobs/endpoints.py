"""Jobs: look, follow, cancel."""

from fastapi import APIRouter, Request
from fastapi.responses import StreamingResponse

from app.db.session import ReadSession, WriteSession
from app.dependencies import AppSettings, AppStore
from app.jobs import events, service
from app.jobs.schemas import Job

router = APIRouter(prefix="/api", tags=["jobs"])


@router.get("/drives/{drive_id}/jobs")
def list_jobs(drive_id: int, session: ReadSession) -> list[Job]:
    """Jobs of the drive, newest first."""
    return service.list_jobs(session, drive_id)


@router.get("/jobs/{job_id}")
def get_job(job_id: int, session: ReadSession) -> Job:
    return service.get_job(session, job_id)


@router.post("/jobs/{job_id}/cancel")
def cancel_job(job_id: int, session: WriteSession) -> Job:
    """Ask the job to stop. A waiting job is cancelled at once, a running one at its next step."""
    return service.cancel_job(session, job_id)


@router.get(
    "/jobs/{job_id}/events",
    response_class=StreamingResponse,
    responses={200: {"content": {"text/event-stream": {}}, "description": "`event: job` with a Job as data."}},
)
async def follow_job(job_id: int, request: Request, store: AppStore, settings: AppSettings) -> StreamingResponse:
    """Server-sent events: the job at each change, until it has ended."""
    return await events.follow(request, store, job_id, poll_seconds=settings.job_poll_seconds)
