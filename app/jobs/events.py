"""Progress of a job as server-sent events.

The store is asked every few hundred milliseconds, in a thread; an event goes out when the job has changed. The stream
ends with the job, when the page goes away, and when the server stops.
"""

import threading
import time
from collections.abc import AsyncIterator

import anyio
from fastapi import Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import StreamingResponse

from app.db.session import Store
from app.errors import NotFound
from app.jobs import service
from app.jobs.schemas import Job

KEEP_ALIVE_SECONDS = 15.0


async def follow(request: Request, store: Store, job_id: int, *, poll_seconds: float) -> StreamingResponse:
    """The stream of one job; NotFound where there is none."""
    first = await run_in_threadpool(_read, store, job_id)
    return StreamingResponse(
        _events(request, store, first, poll_seconds),
        media_type="text/event-stream",
        headers={"Cache-Control": "no-store", "X-Accel-Buffering": "no"},
    )


async def _events(request: Request, store: Store, job: Job, poll_seconds: float) -> AsyncIterator[str]:
    stopping: threading.Event = request.app.state.stopping
    yield _event(job)
    sent_at = time.monotonic()
    while not job.state.is_final and not stopping.is_set() and not await request.is_disconnected():
        await anyio.sleep(poll_seconds)
        try:
            latest = await run_in_threadpool(_read, store, job.id)
        except NotFound:
            return
        if latest != job:
            job, sent_at = latest, time.monotonic()
            yield _event(job)
        elif time.monotonic() - sent_at >= KEEP_ALIVE_SECONDS:
            sent_at = time.monotonic()
            yield ": still here\n\n"


def _read(store: Store, job_id: int) -> Job:
    with store.read() as session:
        return service.get_job(session, job_id)


def _event(job: Job) -> str:
    return f"event: job\ndata: {job.model_dump_json()}\n\n"
