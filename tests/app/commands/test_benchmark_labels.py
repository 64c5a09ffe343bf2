"""``hindsight benchmark labels``: rows for a folder of text, and what it asks for."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from app.cli import main
from tests.labeler.evaluation.test_label_benchmark import detected, truth, write


def test_text_sequences(tmp_path: Path) -> None:
    lines = [truth(frame, 0, "Car", 100) for frame in range(10)]
    root = write(tmp_path, lines, [detected(frame, 100, 0.9) for frame in range(10)])
    result = CliRunner().invoke(main, ["benchmark", "labels", "--root", str(root), "--json"])
    assert result.exit_code == 0, result.stderr
    rows = json.loads(result.stdout)["rows"]
    assert [row["method"] for row in rows] == ["none", "baseline", "ours"]
    assert [(row["p25"], row["r50"], row["idf1"], row["identities_per_object"]) for row in rows] == [
        (1, 1, None, None),
        (1, 1, 1, 1),
        (1, 1, 1, 1),
    ]


@pytest.mark.parametrize("arguments", [[], ["--root", "a", "--drive", "b"]])
def test_asks_for_either_text_or_drives(arguments: list[str]) -> None:
    result = CliRunner().invoke(main, ["benchmark", "labels", *arguments])
    assert result.exit_code == 1
    assert "--root" in result.stderr
    assert "--drive" in result.stderr


def test_a_drive_without_truth_says_so(made_drive: Path, made_model: Path, tmp_path: Path) -> None:
    asked = ["--drive", str(made_drive), "--model", str(made_model), "--workspace", str(tmp_path)]
    result = CliRunner().invoke(main, ["benchmark", "labels", *asked])
    assert result.exit_code == 1
    assert "has no true boxes" in result.stderr
