"""Running the web server with a worker beside it, and stopping both."""

import logging
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

import uvicorn
from fastapi import FastAPI

from app.settings import Settings
from labeler.errors import HindsightError

logger = logging.getLogger(__name__)

CHECK_SECONDS = 0.2
RESTART_SECONDS = 1.0
STOP_SECONDS = 10.0
GRACE_SECONDS = 5


def open_socket(host: str, port: int) -> socket.socket:
    """A listening socket; HindsightError where the address can't be had."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        listening = socket.create_server((host, port), family=family, backlog=2048)
    except OSError as error:
        raise HindsightError(
            f"Can't listen on {host} port {port}: {error.strerror or error}. Stop the program that uses the port, or "
            "start with --port 0 to take a free one."
        ) from error
    # Connections inherit it. Without, the body of each answer waits up to 40 ms for the browser to acknowledge its
    # head; asyncio sees to that only for sockets that it opens itself.
    listening.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return listening


class Server:
    """The web server on a listening socket; :meth:`run` it in the main thread to let Ctrl-C stop it.

    Endless answers are told before uvicorn begins to stop, because it waits for them. ``on_ready`` is called when the
    first request can be answered.
    """

    def __init__(self, app: FastAPI, listening: socket.socket, *, on_ready: Callable[[], None]) -> None:
        self._listening = listening
        config = uvicorn.Config(
            app,
            log_level="warning",
            access_log=False,
            timeout_graceful_shutdown=GRACE_SECONDS,
            server_header=False,
        )
        self._server = _UvicornServer(config, app.state.stopping, on_ready)

    @property
    def url(self) -> str:
        """Where a browser on this machine finds it."""
        address, port = self._listening.getsockname()[:2]
        name = {"0.0.0.0": "localhost", "::": "localhost", "::1": "[::1]"}.get(address, address)
        return f"http://{name}:{port}/"

    def run(self) -> None:
        """Serve until it is stopped."""
        self._server.run(sockets=[self._listening])

    def stop(self) -> None:
        """Let :meth:`run` end, from any thread."""
        self._server.handle_exit(signal.SIGTERM, None)


class _UvicornServer(uvicorn.Server):
    def __init__(self, config: uvicorn.Config, stopping: threading.Event, on_ready: Callable[[], None]) -> None:
        super().__init__(config)
        self._stopping = stopping
        self._on_ready = on_ready

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        if self.started:
            self._on_ready()

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Stop; at once when Ctrl-C comes again. uvicorn's own would send itself the signal once more at the end, and
        SIGTERM would then end the process before its worker is stopped."""
        self._stopping.set()
        self.force_exit = self.should_exit and sig == signal.SIGINT
        self.should_exit = True


@contextmanager
def worker_beside(settings: Settings) -> Iterator[None]:
    """A worker process that lives as long as the block; one that dies is started again."""
    stop = threading.Event()
    keeper = threading.Thread(target=_keep_worker, args=(settings, stop), name="worker-keeper")
    keeper.start()
    try:
        yield
    finally:
        stop.set()
        keeper.join()


def _keep_worker(settings: Settings, stop: threading.Event) -> None:
    while not stop.is_set():
        process = _start_worker(settings)
        while process.poll() is None and not stop.wait(CHECK_SECONDS):
            pass
        if stop.is_set():
            _end(process)
        else:
            logger.error("the worker ended with status %s; starting another", process.returncode)
            stop.wait(RESTART_SECONDS)


def _start_worker(settings: Settings) -> subprocess.Popen[bytes]:
    """In a session of its own, so that Ctrl-C in the terminal reaches the server alone, which then stops the worker."""
    return subprocess.Popen(
        [sys.executable, "-m", "app", "worker", "--parent-pid", str(os.getpid())],
        env=os.environ | settings.as_environment(),
        stdin=subprocess.DEVNULL,
        start_new_session=True,
    )


def _end(process: subprocess.Popen[bytes]) -> None:
    """Ask the worker to stop; its whole group is ended if it does not."""
    process.terminate()
    try:
        process.wait(STOP_SECONDS)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
