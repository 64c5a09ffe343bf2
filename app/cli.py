"""The command ``hindsight``."""

import json
import logging
import signal
import threading
import webbrowser
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from app.db.engine import migrate, open_engine
from app.db.session import Store
from app.drives import service as drives_service
from app.drives.schemas import DriveRegistration, DriveState
from app.main import create_app
from app.serving import open_socket, run_server, url_of, worker_beside
from app.settings import Settings, load_settings
from app.worker import run_worker
from labeler.errors import HindsightError


class _Commands(TyperGroup):
    """Ends with one sentence on standard error where the user can do something about an error."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except HindsightError as error:
            typer.echo(f"Error: {error}", err=True)
            raise typer.Exit(1) from error


main = typer.Typer(
    name="hindsight",
    cls=_Commands,
    help="Label recorded drives automatically, and let a person check them in minutes.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)

Workspace = Annotated[Path | None, typer.Option(help="Folder for the store, uploads, artifacts and exports.")]
ModelFile = Annotated[
    Path | None, typer.Option(exists=True, dir_okay=False, help="YOLOX model file (.onnx) to label drives with.")
]


@main.command()
def serve(
    drives: Annotated[
        list[Path] | None,
        typer.Argument(metavar="[DRIVE]...", exists=True, file_okay=False, help="Drives to register (and to label)."),
    ] = None,
    workspace: Workspace = None,
    host: Annotated[str | None, typer.Option(help="Address to listen on.")] = None,
    port: Annotated[int | None, typer.Option(min=0, max=65535, help="Port; 0 takes a free one.")] = None,
    model: ModelFile = None,
    open_browser: Annotated[bool, typer.Option("--open/--no-open", help="Open the page in a browser.")] = False,
    with_worker: Annotated[
        bool, typer.Option("--worker/--no-worker", help="Run a worker beside the server; else run `hindsight worker`.")
    ] = True,
) -> None:
    """Serve the review page, with a worker that labels and exports."""
    settings = load_settings(workspace=workspace, host=host, port=port, model=model)
    _log_to_stderr()
    listening = open_socket(settings.host, settings.port)
    with listening:
        _register(settings, drives or [])
        url = url_of(listening, settings.host)

        def on_ready() -> None:
            typer.echo(f"Hindsight is at {url} (Ctrl-C stops it).")
            if open_browser:
                webbrowser.open(url)

        app = create_app(settings)
        if with_worker:
            with worker_beside(settings):
                run_server(app, listening, on_ready=on_ready)
        else:
            run_server(app, listening, on_ready=on_ready)


@main.command()
def worker(
    workspace: Workspace = None,
    model: ModelFile = None,
    parent_pid: Annotated[int | None, typer.Option(hidden=True)] = None,
) -> None:
    """Do the jobs of a workspace, until Ctrl-C."""
    settings = load_settings(workspace=workspace, model=model)
    _log_to_stderr()
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda _number, _frame: stop.set())
    run_worker(settings, stop, parent_pid=parent_pid)


@main.command()
def openapi(
    file: Annotated[Path | None, typer.Argument(help="Where to write it; without it, to standard output.")] = None,
) -> None:
    """Write the description of the web server's interface, from which the page's client is made."""
    text = openapi_text()
    if file is None:
        typer.echo(text, nl=False)
    else:
        file.write_text(text, encoding="utf-8")


def openapi_text() -> str:
    """The description of the interface as it lies in frontend/openapi.json."""
    return json.dumps(create_app(Settings()).openapi(), indent=2) + "\n"


def _register(settings: Settings, drives: Sequence[Path]) -> None:
    """Register drives, and queue those that have no labels yet where a model is configured."""
    if not drives:
        return
    engine = open_engine(settings.store_url)
    migrate(engine)
    store = Store(engine)
    for path in drives:
        drive = drives_service.add_local_drive(store, DriveRegistration(path=str(path.absolute())))
        if settings.model is not None and drive.state in (DriveState.NEW, DriveState.FAILED):
            with store.write() as session:
                drives_service.queue_labelling(session, settings, drive.id)
    engine.dispose()


def _log_to_stderr() -> None:
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(name)s: %(message)s")
    logging.getLogger("alembic").setLevel(logging.WARNING)
