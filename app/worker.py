"""The worker process: which kind of job is done by what."""

import os
import threading
from collections.abc import Mapping

from app.db.engine import migrate, open_engine
from app.db.session import Store
from app.exports.writing import run_export_job
from app.jobs.schemas import JobKind
from app.jobs.worker import JobHandler, Worker
from app.settings import Settings
from app.tracks.labelling import run_label_job

HANDLERS: Mapping[str, JobHandler] = {JobKind.LABEL: run_label_job, JobKind.EXPORT: run_export_job}

PARENT_CHECK_SECONDS = 1.0


def run_worker(settings: Settings, stop: threading.Event, *, parent_pid: int | None = None) -> None:
    """Do jobs of the workspace's store until ``stop`` is set, or until the parent process is gone."""
    engine = open_engine(settings.store_url)
    migrate(engine)
    if parent_pid is not None:
        threading.Thread(target=_stop_without_parent, args=(parent_pid, stop), daemon=True).start()
    try:
        Worker(Store(engine), settings, HANDLERS).run(stop)
    finally:
        engine.dispose()


def _stop_without_parent(parent_pid: int, stop: threading.Event) -> None:
    while not stop.wait(PARENT_CHECK_SECONDS):
        if os.getppid() != parent_pid:
            stop.set()
