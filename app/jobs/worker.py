"""The worker: claims jobs from the store and does them, one at a time.

No transaction is open while a job runs. A thread beside it writes progress and a sign of life in short transactions and
reads whether the job is to stop; the job hears of that at its next step, as :class:`labeler.pipeline.types.Cancelled`.
When the worker itself is told to stop, its job goes back to the queue and resumes from its artifacts later.
"""

import logging
import os
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import timedelta
from uuid import uuid4

from app.db.base import now
from app.db.session import Store
from app.jobs import repository
from app.jobs.models import JobRow
from app.jobs.schemas import JobState
from app.settings import Settings
from labeler.errors import HindsightError
from labeler.pipeline.types import Cancelled

logger = logging.getLogger(__name__)


class JobProgress:
    """What a running job says about itself; a ``labeler.pipeline.types.Progress``."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._stage: str | None = None
        self._done = 0
        self._total = 0
        self._stopped = threading.Event()

    def stage(self, name: str, units: int) -> None:
        with self._lock:
            self._stage, self._done, self._total = name, 0, units
        self._raise_if_stopped()

    def advance(self, units: int = 1) -> None:
        with self._lock:
            self._done += units
        self._raise_if_stopped()

    def stop(self) -> None:
        """Let the next step of the job raise Cancelled."""
        self._stopped.set()

    def snapshot(self) -> dict[str, str | int | None]:
        """Values of the job's columns."""
        with self._lock:
            return {"stage": self._stage, "done": self._done, "total": self._total}

    def _raise_if_stopped(self) -> None:
        if self._stopped.is_set():
            raise Cancelled("The job was stopped. What is done so far is kept.")


@dataclass(frozen=True)
class JobContext:
    """What a job gets to do its work."""

    job_id: int
    drive_id: int
    model_path: str | None
    store: Store
    settings: Settings
    progress: JobProgress


JobHandler = Callable[[JobContext], str | None]
"""Does one kind of job. Returns a sentence for the user, or None; raises HindsightError where the user can act."""


class Worker:
    """Does jobs until it is stopped."""

    def __init__(self, store: Store, settings: Settings, handlers: Mapping[str, JobHandler]) -> None:
        self._store = store
        self._settings = settings
        self._handlers = handlers
        self._name = f"{os.getpid()}-{uuid4().hex[:8]}"

    def run(self, stop: threading.Event) -> None:
        """Claim and do jobs until ``stop`` is set."""
        while not stop.is_set():
            if not self.run_one(stop):
                stop.wait(self._settings.job_poll_seconds)

    def run_one(self, stop: threading.Event) -> bool:
        """Do the next job, if there is one, and say whether there was."""
        job = self._claim()
        if job is None:
            return False
        logger.info("job %d (%s of drive %d) begins", job.id, job.kind, job.drive_id)
        progress = JobProgress()
        ended = threading.Event()
        reporter = threading.Thread(target=self._report_until, args=(job.id, progress, stop, ended), daemon=True)
        reporter.start()
        try:
            state, error, message = self._do(job, progress)
        finally:
            ended.set()
            reporter.join()
        with self._store.write() as session:
            repository.report(session, job.id, worker=self._name, values=progress.snapshot())
            if state is JobState.CANCELLED and stop.is_set():
                repository.release(session, job.id, worker=self._name)
            else:
                repository.finish(session, job.id, worker=self._name, state=state, error=error, message=message)
        logger.info("job %d ends: %s", job.id, error or state)
        return True

    def _claim(self) -> JobRow | None:
        stale_before = now() - timedelta(seconds=self._settings.stale_job_seconds)
        with self._store.write() as session:
            repository.end_stale(session, stale_before=stale_before, max_attempts=self._settings.max_job_attempts)
            return repository.claim(session, worker=self._name, stale_before=stale_before)

    def _do(self, job: JobRow, progress: JobProgress) -> tuple[JobState, str | None, str | None]:
        context = JobContext(job.id, job.drive_id, job.model_path, self._store, self._settings, progress)
        try:
            return JobState.DONE, None, self._handlers[job.kind](context)
        except Cancelled:
            return JobState.CANCELLED, None, "Stopped. What is done so far is kept."
        except HindsightError as error:
            return JobState.FAILED, str(error), None
        except Exception:  # whatever a job stumbles over, the worker goes on to the next one
            logger.exception("job %d failed", job.id)
            return (
                JobState.FAILED,
                "The job failed for a reason that is not the drive's fault. The worker's log says why.",
                None,
            )

    def _report_until(self, job_id: int, progress: JobProgress, stop: threading.Event, ended: threading.Event) -> None:
        while not ended.wait(self._settings.job_poll_seconds):
            try:
                with self._store.write() as session:
                    cancel = repository.report(session, job_id, worker=self._name, values=progress.snapshot())
            except Exception:  # a store that is locked for a moment must not end the thread that hears of a stop
                logger.exception("job %d: progress could not be written; trying again", job_id)
                continue
            if cancel is None or cancel or stop.is_set():
                progress.stop()
