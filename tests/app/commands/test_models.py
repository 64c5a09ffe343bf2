"""`hindsight models` at the terminal."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from app.cli import main
from tests.labeler.models.model_server import Behaviour, serving


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder of models."""
    monkeypatch.setenv("HINDSIGHT_MODELS", str(tmp_path / "models"))
    return tmp_path / "models"


def hindsight(*arguments: str) -> Result:
    return CliRunner().invoke(main, ["models", *arguments])


def test_a_model_is_added_listed_found_and_checked(made_model: Path, folder: Path) -> None:
    assert hindsight("add", str(made_model), "--as", "mine", "--licence", "MIT").exit_code == 0
    assert hindsight("path", "mine").stdout.strip() == str(folder / "mine.onnx")
    entries = {entry["name"]: entry for entry in json.loads(hindsight("list", "--json").stdout)}
    assert list(entries)[:4] == ["sim-yolox-nano", "sim-segmentation", "sim-pillars", "yolox-nano"]
    assert (entries["mine"]["task"], entries["mine"]["licence"]) == ("detection", "MIT")
    assert entries["yolox-x"]["path"] is None
    assert entries["sim-yolox-nano"]["path"] == hindsight("path", "sim-yolox-nano").stdout.strip()
    assert "hindsight models pull yolox-x" in hindsight("list").stdout
    assert hindsight("verify").exit_code == 0
    with (folder / "mine.onnx").open("ab") as file:
        file.write(b"?")
    changed = hindsight("verify")
    assert changed.exit_code == 1
    assert "CHANGED mine" in changed.stderr


def test_a_pull_that_fails_says_why_and_ends_with_1(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    for name in ("http_proxy", "HTTP_PROXY"):
        monkeypatch.delenv(name, raising=False)
    behaviour = Behaviour(files={"yolox_nano.onnx": b"?" * 3_659_407})  # the right size, and nothing else
    with serving(behaviour) as address:
        monkeypatch.setenv("HINDSIGHT_MODEL_MIRROR", address)
        result = hindsight("pull", "yolox-nano")
    assert result.exit_code == 1
    assert "Error: The file from" in result.stderr
    assert "is not the published yolox-nano" in result.stderr
    assert not (folder / "yolox-nano.onnx").exists()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("path", "yolox-x"), "hindsight models pull yolox-x"),
        (("path", "nothing"), "There is no model nothing"),
        (("pull", "sim-yolox-nano"), "there is nothing to pull"),
    ],
)
def test_names_that_lead_nowhere(arguments: tuple[str, ...], says: str) -> None:
    result = hindsight(*arguments)
    assert result.exit_code == 1
    assert says in result.stderr
