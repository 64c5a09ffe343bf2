"""``hindsight models``: the models by name. Pulling is the one thing in Hindsight that downloads."""

import json
from pathlib import Path
from types import TracebackType
from typing import Annotated, TypedDict

import typer
from rich.console import Console
from rich.progress import (
    BarColumn,
    DownloadColumn,
    Progress,
    TaskID,
    TextColumn,
    TimeRemainingColumn,
    TransferSpeedColumn,
)
from rich.table import Table

from app.commands.options import AsJson
from app.commands.terminal import say, show_table
from app.settings import load_settings
from labeler.models import OFFICIAL, SHIPPED, ModelCache, choose_named, pull, verify
from labeler.models import inspect as inspect_model

models = typer.Typer(help="List, pull, add and check models.", no_args_is_help=True)

ModelArgument = Annotated[str, typer.Argument(metavar="NAME", help="Name of the model.", show_default=False)]


class ModelEntry(TypedDict):
    """A line of ``hindsight models list``; ``path`` is None where the model is not on this machine."""

    name: str
    task: str
    path: str | None
    size_bytes: int | None
    input: str
    classes: list[str]
    licence: str
    sha256: str | None
    source: str


@models.command("list")
def list_models(as_json: AsJson = False) -> None:
    """Show every model: those that ship, the official ones, and those that were added."""
    entries = _entries(load_settings().model_cache)
    if as_json:
        typer.echo(json.dumps(entries))
        return
    table = Table()
    for heading in ("name", "task", "on this machine", "size", "input", "classes", "licence"):
        table.add_column(heading, justify="right" if heading in ("size", "classes") else "left")
    for entry in entries:
        size = "" if entry["size_bytes"] is None else f"{entry['size_bytes'] / 1e6:.1f} MB"
        here = entry["path"] or f"no: hindsight models pull {entry['name']}"
        classes = str(len(entry["classes"])) if entry["classes"] else ""
        table.add_row(entry["name"], entry["task"], here, size, entry["input"], classes, entry["licence"])
    show_table(table)


@models.command("pull")
def pull_model(name: ModelArgument) -> None:
    """Download an official YOLOX model into the cache. The same command goes on where a pull broke off."""
    settings = load_settings()
    with _PullBar(name) as bar:
        pulled = pull(name, settings.model_cache, progress=bar, mirror=settings.model_mirror)
    if not pulled.fresh:
        say(f"{name} is there already: {pulled.path}")
        return
    how = "as published" if pulled.pinned else "recorded on first use, since nobody has published it"
    say(f"{name} is in {pulled.path}")
    say(f"sha256 {pulled.record.sha256}, {how}")
    say("Drives are labelled with the best official model from now on. Another one is chosen by --model NAME.")


@models.command("path")
def model_path(name: ModelArgument) -> None:
    """Print where the file of a model lies."""
    typer.echo(choose_named(name, load_settings().model_cache).path)


@models.command("add")
def add_model(
    file: Annotated[
        Path, typer.Argument(help="A YOLOX detector or a segmentation, in ONNX form.", exists=True, dir_okay=False)
    ],
    name: Annotated[str, typer.Option("--as", metavar="NAME", help="Name to call it by.", show_default=False)],
    licence: Annotated[str, typer.Option(help="Its licence, to be shown in the list.")] = "not stated",
) -> None:
    """Copy a model file of yours into the cache, under a name."""
    cache = load_settings().model_cache
    record = cache.add(file, name, licence=licence)
    say(
        f"{name}: {record.task} of {len(record.class_names)} classes, input {record.input_shape}, in {cache.path(name)}"
    )


@models.command("verify")
def verify_models() -> None:
    """Check that every model file on this machine is still the one that was published, or taken in."""
    wrong = 0
    for verdict in verify(load_settings().model_cache):
        say(f"{'ok     ' if verdict.is_right else 'CHANGED'} {verdict.name}  {verdict.path}")
        if not verdict.is_right:
            wrong += 1
            say(f"        sha256 {verdict.found or 'none: the file is missing'}, should be {verdict.expected}")
    if wrong:
        say("Delete what is changed and get it again: pull an official model, add one of yours, reinstall Hindsight.")
        raise typer.Exit(1)


def _entries(cache: ModelCache) -> list[ModelEntry]:
    """Those that ship, then the official ones, then those that were added."""
    entries: list[ModelEntry] = []
    for shipped in SHIPPED:
        facts = inspect_model(shipped.path)
        entries.append(
            ModelEntry(
                name=shipped.name,
                task=shipped.task,
                path=str(shipped.path),
                size_bytes=shipped.path.stat().st_size,
                input=facts.input_shape,
                classes=list(facts.class_names),
                licence=shipped.licence,
                sha256=shipped.sha256,
                source=shipped.source,
            )
        )
    records = {record.name: record for record in cache.records()}
    for model in OFFICIAL:
        record = records.pop(model.name, None)
        entries.append(
            ModelEntry(
                name=model.name,
                task=model.task,
                path=str(cache.path(model.name)) if record else None,
                size_bytes=record.size_bytes if record else model.size_bytes,
                input=model.input_shape,
                classes=list(model.class_names),
                licence=model.licence,
                sha256=model.sha256 or (record.sha256 if record else None),
                source=model.url,
            )
        )
    entries += [
        ModelEntry(
            name=record.name,
            task=record.task,
            path=str(cache.path(record.name)),
            size_bytes=record.size_bytes,
            input=record.input_shape,
            classes=list(record.class_names),
            licence=record.licence,
            sha256=record.sha256,
            source=record.source,
        )
        for record in records.values()
    ]
    return entries


class _PullBar:
    """A bar of bytes on standard error; a ``labeler.models.PullProgress``."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._task: TaskID | None = None
        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            DownloadColumn(),
            TransferSpeedColumn(),
            TimeRemainingColumn(),
            console=Console(stderr=True),
        )

    def waiting(self) -> None:
        say(f"Another process pulls {self._name}; waiting for it.")

    def begin(self, *, done_bytes: int, total_bytes: int | None) -> None:
        if done_bytes:
            say(f"Going on behind the {done_bytes / 1e6:.1f} MB that came before.")
        self._task = self._bar.add_task(self._name, total=total_bytes, completed=done_bytes)

    def advance(self, count_bytes: int) -> None:
        if self._task is not None:
            self._bar.advance(self._task, count_bytes)

    def __enter__(self) -> "_PullBar":
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()
