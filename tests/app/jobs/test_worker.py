"""The worker on real jobs in a real store; what a job does is made up where it is not the thing under test."""

import threading
from collections.abc import Callable
from datetime import timedelta

import pytest

from app.db.base import now
from app.db.session import Store
from app.jobs import repository, service
from app.jobs.schemas import Job, JobState
from app.jobs.worker import JobContext, Worker
from app.settings import Settings
from labeler.errors import HindsightError

MINUTE = timedelta(minutes=1)


def _queue(store: Store, drive_id: int, kind: str = "label") -> int:
    with store.write() as session:
        return repository.insert(session, drive_id=drive_id, kind=kind).id


def _job(store: Store, job_id: int) -> Job:
    with store.read() as session:
        return service.get_job(session, job_id)


def _worker(store: Store, settings: Settings, work: Callable[[JobContext], str | None]) -> Worker:
    return Worker(store, settings, {"label": work, "export": work})


def _fail(message: str, error: type[Exception] = HindsightError) -> Callable[[JobContext], str | None]:
    def work(_context: JobContext) -> str | None:
        raise error(message)

    return work


def test_jobs_are_done_in_order(store: Store, settings: Settings, drive_id: int) -> None:
    ids = [_queue(store, drive_id), _queue(store, drive_id, "export")]
    done: list[int] = []
    worker = _worker(store, settings, lambda context: done.append(context.job_id))
    stop = threading.Event()
    assert [worker.run_one(stop), worker.run_one(stop), worker.run_one(stop)] == [True, True, False]
    assert done == ids
    job = _job(store, ids[0])
    assert (job.state, job.error) == (JobState.DONE, None)
    assert job.started_at is not None
    assert job.finished_at is not None
    assert job.created_at <= job.started_at <= job.finished_at


def test_progress_is_written_while_the_job_runs(store: Store, settings: Settings, drive_id: int) -> None:
    job_id = _queue(store, drive_id)
    seen: list[tuple[str | None, int, int]] = []

    def work(context: JobContext) -> str:
        context.progress.stage("detect", 10)
        context.progress.advance(4)
        while not seen:  # until the thread beside has written it
            job = _job(store, job_id)
            if job.done:
                seen.append((job.stage, job.done, job.total))
        context.progress.stage("track", 3)
        context.progress.advance(3)
        return "All good."

    _worker(store, settings, work).run_one(threading.Event())
    assert seen == [("detect", 4, 10)]
    job = _job(store, job_id)
    assert (job.stage, job.done, job.total, job.message) == ("track", 3, 3, "All good.")


@pytest.mark.parametrize(
    ("work", "error"),
    [
        (_fail("The drive is empty."), "The drive is empty."),
        (_fail("secret detail", ValueError), "The job failed for a reason that is not the drive's fault."),
    ],
)
def test_failures_are_told(
    store: Store, settings: Settings, drive_id: int, work: Callable[[JobContext], str | None], error: str
) -> None:
    job_id = _queue(store, drive_id)
    _worker(store, settings, work).run_one(threading.Event())
    job = _job(store, job_id)
    assert job.state is JobState.FAILED
    assert job.error is not None
    assert job.error.startswith(error)


def _advance_for_ever(context: JobContext) -> None:
    context.progress.stage("detect", 1)
    while True:
        context.progress.advance(0)


def test_a_running_job_is_cancelled(store: Store, settings: Settings, drive_id: int) -> None:
    job_id = _queue(store, drive_id)

    def work(context: JobContext) -> None:
        with store.write() as session:
            service.cancel_job(session, job_id)
        _advance_for_ever(context)

    _worker(store, settings, work).run_one(threading.Event())
    assert _job(store, job_id).state is JobState.CANCELLED


def test_a_waiting_job_is_cancelled_at_once(store: Store, settings: Settings, drive_id: int) -> None:
    job_id = _queue(store, drive_id)
    with store.write() as session:
        assert service.cancel_job(session, job_id).state is JobState.CANCELLED
    assert not _worker(store, settings, _fail("must not run")).run_one(threading.Event())


def test_a_worker_that_stops_puts_its_job_back(store: Store, settings: Settings, drive_id: int) -> None:
    job_id = _queue(store, drive_id)
    stop = threading.Event()

    def work(context: JobContext) -> None:
        stop.set()
        _advance_for_ever(context)

    _worker(store, settings, work).run_one(stop)
    assert _job(store, job_id).state is JobState.QUEUED
    _worker(store, settings, lambda _: None).run_one(threading.Event())
    assert _job(store, job_id).state is JobState.DONE


def test_a_job_of_a_deleted_drive_stops(store: Store, settings: Settings, drive_id: int) -> None:
    job_id = _queue(store, drive_id)

    def work(context: JobContext) -> None:
        with store.write() as session:
            from app.drives.repository import delete_drive

            delete_drive(session, drive_id)
        _advance_for_ever(context)

    assert _worker(store, settings, work).run_one(threading.Event())
    with store.read() as session:
        assert repository.find(session, job_id) is None


def _die(store: Store, *, minutes_ago: int) -> None:
    """A worker claims the next job, and is never heard of again."""
    with store.write() as session:
        job = repository.claim(session, worker="dead", stale_before=now() - MINUTE)
        assert job is not None
        job.heartbeat_at = now() - minutes_ago * MINUTE


def test_a_dead_workers_job_is_taken_up_again(store: Store, settings: Settings, drive_id: int) -> None:
    job_id = _queue(store, drive_id)
    _die(store, minutes_ago=2)
    assert _worker(store, settings, lambda _: None).run_one(threading.Event())
    assert _job(store, job_id).state is JobState.DONE


def test_a_living_workers_job_is_left_alone(store: Store, settings: Settings, drive_id: int) -> None:
    job_id = _queue(store, drive_id)
    _die(store, minutes_ago=0)
    assert not _worker(store, settings, _fail("must not run")).run_one(threading.Event())
    assert _job(store, job_id).state is JobState.RUNNING


def test_a_job_that_kills_every_worker_is_given_up(store: Store, settings: Settings, drive_id: int) -> None:
    job_id = _queue(store, drive_id)
    for _ in range(settings.max_job_attempts):
        _die(store, minutes_ago=2)
    assert not _worker(store, settings, _fail("must not run")).run_one(threading.Event())
    job = _job(store, job_id)
    assert job.state is JobState.FAILED
    assert job.error is not None
    assert "died each time" in job.error


def test_a_dead_workers_cancelled_job_ends(store: Store, settings: Settings, drive_id: int) -> None:
    job_id = _queue(store, drive_id)
    _die(store, minutes_ago=2)
    with store.write() as session:
        service.cancel_job(session, job_id)
    assert not _worker(store, settings, _fail("must not run")).run_one(threading.Event())
    job = _job(store, job_id)
    assert (job.state, job.error) == (JobState.CANCELLED, None)


def test_a_worker_that_was_given_up_can_not_end_the_job(store: Store, settings: Settings, drive_id: int) -> None:
    job_id = _queue(store, drive_id)

    def work(_context: JobContext) -> None:
        with store.write() as session:  # meanwhile another worker has taken it
            job = repository.find(session, job_id)
            assert job is not None
            job.worker = "another"

    _worker(store, settings, work).run_one(threading.Event())
    assert _job(store, job_id).state is JobState.RUNNING


def test_two_workers_share_the_jobs(store: Store, settings: Settings, drive_id: int) -> None:
    ids = [_queue(store, drive_id) for _ in range(10)]
    done: list[int] = []
    stop = threading.Event()

    def work(context: JobContext) -> None:
        done.append(context.job_id)
        if len(done) == len(ids):
            stop.set()

    threads = [threading.Thread(target=_worker(store, settings, work).run, args=(stop,)) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(30)
    assert sorted(done) == ids
