"""``hindsight audit`` as a person runs it: on the drive made by code, and where it can't go on."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from app.cli import main
from app.commands.label import store_labels
from app.settings import Settings
from labeler.evaluation.made_up import MadeUp, made_up_labels, write_made_up_drive
from labeler.pipeline import SilentProgress
from tests.made_drive import write_drive

SIZE = MadeUp(frames=5, cameras=2, objects=3)


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, list(arguments))


def test_a_labelled_drive(made_model: Path, tmp_path: Path) -> None:
    """Half of what is sure is hidden; the same seed says the same."""
    made_drive = write_drive(tmp_path / "made drive", frames=30)
    where = ("--workspace", str(tmp_path / "workspace"))
    labelled = run("label", str(made_drive), "--model", str(made_model), "--executor", "serial", *where)
    assert labelled.exit_code == 0, labelled.stderr
    asked = ("audit", str(made_drive), "--share", "0.5", "--confidence", "0.3", *where)
    first, again = run(*asked, "--json"), run(*asked, "--json")
    assert first.exit_code == 0, first.stderr
    assert first.stdout == again.stdout
    found = json.loads(first.stdout)
    assert found["hidden"] >= 20
    assert found["box"]["of"] == found["hidden"] == sum(row["box"]["of"] for row in found["by_height"])
    assert sum(row["box"]["of"] for row in found["by_distance"]) == found["hidden"]  # all cameras are calibrated
    table = run(*asked).stdout
    assert f"{found['hidden']} of {found['confident']}" in table

    few = run("audit", str(made_drive), "--share", "0.05", "--confidence", "0.3", *where)
    assert few.exit_code == 0
    assert "Warning: only" in few.stderr

    nothing = run("audit", str(made_drive), "--confidence", "1", *where)
    assert nothing.exit_code == 1
    assert "there is nothing to tell" in nothing.stderr


@pytest.fixture
def drive(tmp_path: Path) -> Path:
    return write_made_up_drive(tmp_path / "drive", SIZE)


def test_a_drive_that_is_not_labelled(drive: Path, tmp_path: Path) -> None:
    result = run("audit", str(drive), "--workspace", str(tmp_path / "workspace"))
    assert result.exit_code == 1
    assert "has no labels of drive. Label it first" in result.stderr


def test_labels_whose_files_are_gone(drive: Path, tmp_path: Path) -> None:
    settings = Settings(workspace=tmp_path / "workspace")
    store_labels(settings, drive, made_up_labels(SIZE), scene=None, model_name="made up", progress=SilentProgress())
    result = run("audit", str(drive), "--workspace", str(tmp_path / "workspace"))
    assert result.exit_code == 1
    assert "does not have all that the labels of drive were made from" in result.stderr
    assert "Label the drive again" in result.stderr


def test_a_share_that_makes_no_sense(drive: Path, tmp_path: Path) -> None:
    result = run("audit", str(drive), "--share", "0.9", "--workspace", str(tmp_path / "workspace"))
    assert result.exit_code == 1
    assert "at most 0.5" in result.stderr
