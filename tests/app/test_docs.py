"""Every command, option and setting is described, and nothing is described that is not there."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from typer.main import get_command

from app.cli import main
from app.settings import PREFIX, Settings

DOCS = Path(__file__).resolve().parents[2] / "docs"


def commands_of(command: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Every command below a typer command that does something itself, by its full name."""
    if hasattr(command, "commands"):
        for part, below in command.commands.items():
            yield from commands_of(below, f"{name} {part}".strip())
    elif not command.hidden:
        yield name, command


COMMANDS: dict[str, Any] = dict(commands_of(get_command(main)))


def sections() -> dict[str, str]:
    """The text of commands.md by the command that it is about."""
    text = (DOCS / "commands.md").read_text("utf-8")
    parts = re.split(r"^## `hindsight ([a-z -]*[a-z])[^`]*`$", text, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def rows_of(text: str) -> list[list[str]]:
    """The cells of each row of the tables in a text."""
    return [line.strip("|").split(" | ") for line in text.splitlines() if line.startswith("| `")]


def test_every_command_has_a_section() -> None:
    assert set(sections()) == set(COMMANDS)


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_every_option_has_a_row(name: str) -> None:
    options = {
        option
        for parameter in COMMANDS[name].params
        if parameter.param_type_name == "option" and not parameter.hidden
        for option in (*parameter.opts, *parameter.secondary_opts)
    }
    described = {option for row in rows_of(sections()[name]) for option in re.findall(r"`(--?[a-z-]+)", row[0])}
    assert described == options - {"--help"}


def test_every_setting_has_a_row_with_its_description() -> None:
    text = (DOCS / "settings.md").read_text("utf-8")
    described = {row[0].strip(" `"): row[2].strip() for row in rows_of(text) if len(row) == 3}
    assert described == {f"{PREFIX}{name.upper()}": field.description for name, field in Settings.model_fields.items()}
