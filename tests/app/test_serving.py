"""``hindsight serve`` as a process: it starts, labels with its worker, and stops."""

import re
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import psutil
import pytest

from app.serving import open_socket
from labeler.errors import HindsightError


@contextmanager
def _serving(*arguments: str, stop_by: signal.Signals = signal.SIGINT) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """The process and its address; it is told to stop at the end, and must then be gone with its worker."""
    process = subprocess.Popen(
        [sys.executable, "-m", "app", "serve", "--port", "0", "--no-open", *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        cwd=Path(__file__).parents[2],
    )
    assert process.stderr is not None
    try:
        url = ""
        for line in process.stderr:
            if found := re.search(r"http://127\.0\.0\.1:\d+/", line):
                url = found[0]
                break
        assert url
        yield process, url
        children = psutil.Process(process.pid).children(recursive=True) if process.poll() is None else []
        process.send_signal(stop_by)
        assert process.wait(30) == 0
        assert [child for child in children if child.is_running() and child.status() != psutil.STATUS_ZOMBIE] == []
    finally:
        process.kill()
        process.wait()
        process.stderr.close()


def test_serving_a_drive_labels_it_and_stops_cleanly(tmp_path: Path, made_drive: Path, made_model: Path) -> None:
    with _serving(str(made_drive), "--workspace", str(tmp_path / "w"), "--model", str(made_model)) as (_, url):
        (drive,) = httpx.get(f"{url}api/drives").json()
        assert drive["name"] == "made drive"
        with httpx.stream("GET", f"{url}api/jobs/{drive['job']['id']}/events", timeout=120) as answer:
            last = [line for line in answer.iter_lines() if line.startswith("data: ")][-1]
        assert '"state":"done"' in last
        assert httpx.get(f"{url}api/drives/{drive['id']}").json()["state"] == "ready"
        assert (tmp_path / "w" / "hindsight.db").is_file()


@pytest.mark.parametrize("stop_by", [signal.SIGINT, signal.SIGTERM])
def test_the_worker_stops_with_the_server(tmp_path: Path, stop_by: signal.Signals) -> None:
    with _serving("--workspace", str(tmp_path), stop_by=stop_by) as (process, url):
        assert httpx.get(f"{url}api/health").status_code == 200
        assert any("worker" in child.cmdline() for child in psutil.Process(process.pid).children())


def test_stopping_does_not_wait_for_pages_that_follow_a_job(tmp_path: Path, made_drive: Path, made_model: Path) -> None:
    with _serving(str(made_drive), "--workspace", str(tmp_path), "--model", str(made_model), "--no-worker") as (
        process,
        url,
    ):
        (drive,) = httpx.get(f"{url}api/drives").json()
        with httpx.stream("GET", f"{url}api/jobs/{drive['job']['id']}/events", timeout=60) as answer:
            lines = answer.iter_lines()
            assert next(lines) == "event: job"
            process.send_signal(signal.SIGTERM)
            assert '"state":"queued"' in "".join(lines)  # the stream ends, whole
        assert process.wait(30) == 0


def test_a_port_in_use_is_told() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(HindsightError, match=f"port {port}: .*--port 0"):
            open_socket("127.0.0.1", port)


def test_the_body_of_an_answer_does_not_wait_for_its_head_to_be_acknowledged() -> None:
    with open_socket("127.0.0.1", 0) as listening, socket.create_connection(listening.getsockname()):
        connection, _ = listening.accept()
        with connection:
            assert connection.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)


def test_a_workspace_that_can_not_be_made_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")
    ended = subprocess.run(
        [sys.executable, "-m", "app", "serve", "--port", "0", "--workspace", str(tmp_path / "file" / "w")],
        capture_output=True,
        text=True,
        check=False,
        cwd=Path(__file__).parents[2],
    )
    assert ended.returncode == 1
    assert "Error: " in ended.stderr
    assert "Traceback" not in ended.stderr
