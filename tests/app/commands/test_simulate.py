"""``hindsight simulate`` as a person runs it; tests/labeler/simulation/test_recording.py has what it records."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from app.cli import main


def test_a_folder_that_is_there_is_named_and_left_alone(tmp_path: Path) -> None:
    result = CliRunner().invoke(main, ["simulate", str(tmp_path), "--frames", "1"])
    assert result.exit_code == 1
    assert "is there already. Choose another folder, or delete it first." in result.stderr.replace("\n", " ")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("options", "exit_code", "message"),
    [
        # typer refuses what is out of a plain range
        (("--frames", "0"), 2, "--frames"),
        (("--rate", "0"), 2, "--rate"),
        (("--lidar-channels", "16"), 2, "--lidar-channels"),
        # names are looked up
        (("--town", "atlantis"), 1, "there is no town called 'atlantis'; choose one of"),
        (("--light", "moonlight"), 1, "there is no light called 'moonlight'; choose one of"),
    ],
)
def test_wrong_options_are_refused(options: tuple[str, str], exit_code: int, message: str, tmp_path: Path) -> None:
    result = CliRunner().invoke(main, ["simulate", str(tmp_path / "drive"), *options])
    assert result.exit_code == exit_code
    assert message in " ".join(result.stderr.split())
    assert list(tmp_path.iterdir()) == []
