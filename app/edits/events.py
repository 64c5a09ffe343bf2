"""What others change in a drive, as server-sent events: its revision, whenever it has grown.

The store is asked every few hundred milliseconds, in a thread. The stream ends when the page goes away, when the drive
is deleted, and when the server stops.
"""

import threading
import time
from collections.abc import AsyncIterator

import anyio
from fastapi import Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import StreamingResponse

from app.db.session import Store
from app.edits import service
from app.edits.schemas import DriveRevision
from app.errors import NotFound
from app.jobs.events import KEEP_ALIVE_SECONDS


async def follow(request: Request, store: Store, drive_id: int, *, poll_seconds: float) -> StreamingResponse:
    """The stream of one drive; NotFound where there is none."""
    first = await run_in_threadpool(_read, store, drive_id)
    return StreamingResponse(
        _events(request, store, drive_id, first, poll_seconds),
        media_type="text/event-stream",
        headers={"Cache-Control": "no-store", "X-Accel-Buffering": "no"},
    )


async def _events(
    request: Request, store: Store, drive_id: int, known: DriveRevision, poll_seconds: float
) -> AsyncIterator[str]:
    stopping: threading.Event = request.app.state.stopping
    yield _event(known)
    sent_at = time.monotonic()
    while not stopping.is_set() and not await request.is_disconnected():
        await anyio.sleep(poll_seconds)
        try:
            latest = await run_in_threadpool(_read, store, drive_id)
        except NotFound:
            return
        if latest.revision != known.revision:
            known, sent_at = latest, time.monotonic()
            yield _event(known)
        elif time.monotonic() - sent_at >= KEEP_ALIVE_SECONDS:
            sent_at = time.monotonic()
            yield ": still here\n\n"


def _read(store: Store, drive_id: int) -> DriveRevision:
    with store.read() as session:
        return service.get_revision(session, drive_id)


def _event(revision: DriveRevision) -> str:
    return f"event: revision\ndata: {revision.model_dump_json()}\n\n"
