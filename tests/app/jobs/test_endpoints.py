"""Jobs over HTTP, and their events from a real server: answers without end can't be had in one process."""

import json
import threading
from collections.abc import Iterator

import httpx
import pytest

from app.db.session import Store
from app.jobs import repository
from app.main import create_app
from app.serving import Server, open_socket
from app.settings import Settings
from tests.app.browser import Browser


@pytest.fixture
def job_id(store: Store, drive_id: int) -> int:
    """A waiting job."""
    with store.write() as session:
        return repository.insert(session, drive_id=drive_id, kind="label").id


@pytest.fixture
def server(settings: Settings) -> Iterator[Server]:
    ready = threading.Event()
    with open_socket("127.0.0.1", 0) as listening:
        server = Server(create_app(settings), listening, on_ready=ready.set)
        thread = threading.Thread(target=server.run)
        thread.start()
        assert ready.wait(30)
        yield server
        server.stop()
        thread.join(30)
        assert not thread.is_alive()


def _events(lines: Iterator[str]) -> Iterator[dict[str, object]]:
    """The jobs in a stream of server-sent events."""
    for line in lines:
        if line.startswith("data: "):
            yield json.loads(line.removeprefix("data: "))
        else:
            assert line in ("", "event: job")


def _set(store: Store, job_id: int, **values: object) -> None:
    with store.write() as session:
        job = repository.find(session, job_id)
        assert job is not None
        for name, value in values.items():
            setattr(job, name, value)


def test_jobs_of_a_drive(client: Browser, store: Store, drive_id: int, job_id: int) -> None:
    with store.write() as session:
        second = repository.insert(session, drive_id=drive_id, kind="export").id
    assert [job["id"] for job in client.get(f"/api/drives/{drive_id}/jobs").json()] == [second, job_id]
    job = client.get(f"/api/jobs/{job_id}").json()
    assert (job["state"], job["stage"], job["done"], job["total"], job["started_at"]) == ("queued", None, 0, 0, None)
    assert job["created_at"].endswith("Z")


def test_cancelling(client: Browser, job_id: int) -> None:
    assert client.post(f"/api/jobs/{job_id}/cancel").json()["state"] == "cancelled"
    assert client.post(f"/api/jobs/{job_id}/cancel").json()["state"] == "cancelled"  # and stays so


def test_no_such_job(client: Browser) -> None:
    for method, path in (("GET", "/api/jobs/9"), ("POST", "/api/jobs/9/cancel"), ("GET", "/api/jobs/9/events")):
        assert client.request(method, path).status_code == 404


def test_events_tell_every_change_and_end_with_the_job(server: Server, store: Store, job_id: int) -> None:
    with httpx.stream("GET", f"{server.url}api/jobs/{job_id}/events", timeout=30) as answer:
        assert answer.headers["content-type"].startswith("text/event-stream")
        events = _events(answer.iter_lines())
        assert next(events)["state"] == "queued"
        _set(store, job_id, state="running", stage="detect", done=3, total=9)
        running = next(events)
        assert (running["state"], running["stage"], running["done"], running["total"]) == ("running", "detect", 3, 9)
        _set(store, job_id, state="done")
        assert next(events)["state"] == "done"
        assert list(events) == []


def test_events_of_a_job_that_has_ended(server: Server, store: Store, job_id: int) -> None:
    _set(store, job_id, state="failed", error="No.")
    answer = httpx.get(f"{server.url}api/jobs/{job_id}/events", timeout=30)
    assert [event["error"] for event in _events(iter(answer.text.splitlines()))] == ["No."]


def test_events_end_when_the_drive_is_deleted(server: Server, store: Store, drive_id: int, job_id: int) -> None:
    with httpx.stream("GET", f"{server.url}api/jobs/{job_id}/events", timeout=30) as answer:
        events = _events(answer.iter_lines())
        assert next(events)["state"] == "queued"
        assert httpx.delete(f"{server.url}api/drives/{drive_id}").status_code == 204
        assert list(events) == []


def test_events_end_when_the_server_stops(server: Server, job_id: int) -> None:
    with httpx.stream("GET", f"{server.url}api/jobs/{job_id}/events", timeout=30) as answer:
        events = _events(answer.iter_lines())
        assert next(events)["state"] == "queued"
        server.stop()
        assert list(events) == []


def test_a_stream_says_that_it_is_still_there(server: Server, job_id: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.jobs.events.KEEP_ALIVE_SECONDS", 0.0)
    with httpx.stream("GET", f"{server.url}api/jobs/{job_id}/events", timeout=30) as answer:
        lines = (line for line in answer.iter_lines() if line)
        assert [next(lines).split(":")[0] for _ in range(3)] == ["event", "data", ""]
