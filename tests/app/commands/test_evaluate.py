"""``hindsight evaluate`` as a person runs it, on a made-up drive with truth."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from app.cli import main
from app.commands.label import store_labels
from app.settings import Settings
from labeler.evaluation.made_up import MadeUp, made_up_labels, write_made_up_drive
from labeler.pipeline import SilentProgress

SIZE = MadeUp(frames=5, cameras=2, objects=3)


@pytest.fixture
def drive(tmp_path: Path) -> Path:
    return write_made_up_drive(tmp_path / "drive", SIZE)


@pytest.fixture
def labelled(drive: Path, tmp_path: Path) -> Path:
    """The drive, with labels in the workspace."""
    settings = Settings(workspace=tmp_path / "workspace")
    store_labels(settings, drive, made_up_labels(SIZE), scene=None, model_name="made up", progress=SilentProgress())
    return drive


def evaluate(drive: Path, *options: str) -> Result:
    return CliRunner().invoke(main, ["evaluate", str(drive), "--workspace", str(drive.parent / "workspace"), *options])


def test_json_is_one_object_on_standard_output(labelled: Path) -> None:
    result = evaluate(labelled, "--json")
    assert result.exit_code == 0
    found = json.loads(result.stdout)
    # six objects stand 5 to 100 m away, four of them within 80 m, in each of five frames
    assert (found["truth_count"], found["dont_care_count"]) == (20, 10)
    assert {(row["method"], row["cameras"], row["truth"], row["iou"]) for row in found["rows"]} == {
        (method, cameras, truth, iou)
        for method in ("without-tracking", "single-camera", "multi-camera")
        for cameras in ("all", "front")
        for truth in ("whole", "visible")
        for iou in (0.25, 0.5)
    }
    assert set(found["tracking"]) >= {"hota", "idf1", "id_switches"}
    assert set(found["merges"]) == {"right", "wrong", "missed"}


def test_the_table_names_all_methods(labelled: Path) -> None:
    lines = evaluate(labelled).stdout.splitlines()
    (line,) = (line for line in lines if line.split("│")[1:4] == [" multi-camera     ", " front   ", " whole   "])
    assert all("/" in cell for cell in line.split("│")[6:10:3])
    assert any("HOTA" in line for line in lines)
    assert any(line.startswith("merges:") for line in lines)


def test_options_reach_the_counting(labelled: Path) -> None:
    found = json.loads(
        evaluate(labelled, "--json", "--confidence", "0.95", "--max-distance", "50", "--classes", "agnostic").stdout
    )
    assert (found["confidence"], found["max_distance_m"], found["classes"]) == (0.95, 50, "agnostic")
    assert all(row["tp"] == row["fp"] == 0 for row in found["rows"])  # the labels have .9 and less


def test_a_report(labelled: Path, tmp_path: Path) -> None:
    result = evaluate(labelled, "--report", str(tmp_path / "report.html"), "--json")
    assert "report.html" in result.stderr
    assert "<svg" in (tmp_path / "report.html").read_text("utf-8")
    assert json.loads(result.stdout)["drive"] == "drive"


def test_a_drive_that_is_not_labelled(drive: Path) -> None:
    result = evaluate(drive)
    assert result.exit_code == 1
    assert "has no labels of drive. Label it first" in result.stderr
    assert result.stdout == ""
    assert not (drive.parent / "workspace").exists()  # asking makes nothing


def test_a_drive_without_truth(labelled: Path) -> None:
    (labelled / "annotations_2d.feather").unlink()
    result = evaluate(labelled)
    assert result.exit_code == 1
    assert "has no true boxes in its images" in result.stderr


def test_the_benchmark_says_how_long_it_took() -> None:
    result = CliRunner().invoke(
        main, ["benchmark", "evaluate", "--frames", "3", "--cameras", "2", "--objects", "2", "--json"]
    )
    assert result.exit_code == 0
    assert json.loads(result.stdout)["evaluate_seconds"] > 0
