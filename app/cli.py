"""The command ``hindsight``."""

import json
from pathlib import Path
from typing import Annotated

import typer

from app.main import create_app
from app.settings import Settings

main = typer.Typer(
    name="hindsight",
    help="Label recorded drives automatically, and let a person check them in minutes.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)


@main.callback()
def hindsight() -> None:
    """Label recorded drives automatically, and let a person check them in minutes."""


@main.command()
def openapi(
    file: Annotated[Path | None, typer.Argument(help="Where to write it; without it, to standard output.")] = None,
) -> None:
    """Write the description of the web server's interface, from which the page's client is made."""
    text = json.dumps(create_app(Settings()).openapi(), indent=2) + "\n"
    if file is None:
        typer.echo(text, nl=False)
    else:
        file.write_text(text, encoding="utf-8")
