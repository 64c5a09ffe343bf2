"""The command ``hindsight``: its subcommands, and how errors reach a person."""

import json
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from app.commands.audit import audit
from app.commands.benchmark import benchmark
from app.commands.demo import demo
from app.commands.evaluate import evaluate
from app.commands.label import label
from app.commands.models import models
from app.commands.record_carla import record_carla
from app.commands.serve import serve, worker
from app.commands.simulate import simulate
from app.commands.terminal import INTERRUPTED, say
from app.commands.train import train
from app.main import create_app
from app.settings import Settings
from labeler.errors import HindsightError


class _Commands(TyperGroup):
    """Ends with one sentence on standard error where the user can do something about an error, or pressed Ctrl-C."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except HindsightError as error:
            say(f"Error: {error}")
            raise typer.Exit(1) from error
        except KeyboardInterrupt as error:
            say("Stopped. What was done is kept: run the same command again to go on from there.")
            raise typer.Exit(INTERRUPTED) from error


main = typer.Typer(
    name="hindsight",
    cls=_Commands,
    help="Label recorded drives automatically, and let a person check them in minutes.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
for command in (demo, label, evaluate, audit, simulate, record_carla, serve, worker):
    main.command()(command)
main.add_typer(models, name="models")
main.add_typer(benchmark, name="benchmark")
main.add_typer(train, name="train")


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
