"""``hindsight serve`` and ``hindsight worker``: the review page, and who does its jobs."""

import logging
import signal
import threading
import webbrowser
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer

from app.commands.options import ModelName, OpenBrowser, Port, WorkspaceFolder
from app.db.engine import migrate, open_engine
from app.db.session import Store
from app.drives import service as drives_service
from app.drives.schemas import DriveRegistration, DriveState
from app.main import create_app
from app.serving import Server, open_socket, worker_beside
from app.settings import Settings, load_settings
from app.worker import run_worker


def serve(
    drives: Annotated[
        list[Path] | None,
        typer.Argument(metavar="[DRIVE]...", exists=True, file_okay=False, help="Drives to register (and to label)."),
    ] = None,
    workspace: WorkspaceFolder = None,
    host: Annotated[str | None, typer.Option(help="Address to listen on. (default: 127.0.0.1)")] = None,
    port: Port = None,
    model: ModelName = None,
    open_browser: OpenBrowser = False,
    with_worker: Annotated[
        bool, typer.Option("--worker/--no-worker", help="Run a worker beside the server; else run `hindsight worker`.")
    ] = True,
) -> None:
    """Serve the review page, with a worker that labels and exports."""
    settings = load_settings(workspace=workspace, host=host, port=port, model=model)
    serve_page(settings, drives=drives or (), open_browser=open_browser, with_worker=with_worker)


def worker(
    workspace: WorkspaceFolder = None,
    model: ModelName = None,
    parent_pid: Annotated[int | None, typer.Option(hidden=True)] = None,
) -> None:
    """Do the jobs of a workspace, until Ctrl-C."""
    settings = load_settings(workspace=workspace, model=model)
    _log_to_stderr()
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda _number, _frame: stop.set())
    run_worker(settings, stop, parent_pid=parent_pid)


def serve_page(settings: Settings, *, drives: Sequence[Path] = (), open_browser: bool, with_worker: bool) -> None:
    """Serve until Ctrl-C, after registering ``drives``."""
    _log_to_stderr()
    with open_socket(settings.host, settings.port) as listening:
        _prepare(settings, drives)

        def on_ready() -> None:
            typer.echo(f"Hindsight is at {server.url} (Ctrl-C stops it).", err=True)
            if open_browser:
                webbrowser.open(server.url)

        server = Server(create_app(settings), listening, on_ready=on_ready)
        with worker_beside(settings) if with_worker else nullcontext():
            server.run()


def _prepare(settings: Settings, drives: Sequence[Path]) -> None:
    """Open the store, register drives, and queue those that have no labels yet where a model suits them."""
    engine = open_engine(settings.store_url)
    migrate(engine)
    store = Store(engine)
    for path in drives:
        drive = drives_service.add_local_drive(store, DriveRegistration(path=str(path.absolute())))
        if drive.state in (DriveState.NEW, DriveState.FAILED):
            with store.write() as session:
                drives_service.queue_if_suited(session, settings, drive.id)
    engine.dispose()


def _log_to_stderr() -> None:
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(name)s: %(message)s")
    for chatty in ("alembic", "websockets"):
        logging.getLogger(chatty).setLevel(logging.WARNING)
