"""``hindsight benchmark trackers``: what it prints, without the minutes that a measurement takes."""

import json

import pytest
from typer.testing import CliRunner

from app.cli import main
from labeler.evaluation.tracker_benchmark import OBJECTS, SkippedTracker, TrackerRow, TrackerTimes


@pytest.fixture(autouse=True)
def measured(monkeypatch: pytest.MonkeyPatch) -> None:
    def measure(**_: object) -> TrackerTimes:
        speeds = zip(OBJECTS, (2500.0, 1250.5, 800.0, 300.0), strict=True)
        rows = [TrackerRow(tracker="ours", objects=count, frames_per_cpu_second=speed) for count, speed in speeds]
        absent = SkippedTracker(tracker="motpy", reason="motpy is not installed: pip install it")
        return TrackerTimes(rows=rows, skipped=[absent], versions={}, frames=20, runs=1, seed=0)

    monkeypatch.setattr("app.commands.benchmark.benchmark_trackers", measure)


def test_json_is_one_object_on_standard_output() -> None:
    found = json.loads(CliRunner().invoke(main, ["benchmark", "trackers", "--json"]).stdout)
    assert found["rows"][1] == {"tracker": "ours", "objects": 60, "frames_per_cpu_second": 1250.5}
    assert [row["objects"] for row in found["rows"]] == [20, 60, 100, 300]
    assert [one["tracker"] for one in found["skipped"]] == ["motpy"]


def test_the_table_has_a_line_for_each_tracker_and_says_who_is_missing() -> None:
    result = CliRunner().invoke(main, ["benchmark", "trackers"])
    (line,) = (line for line in result.stdout.splitlines() if "ours" in line)
    assert [cell.strip() for cell in line.split("│")[1:-1]] == ["ours", "2500", "1250", "800", "300"]
    assert "Skipped motpy: motpy is not installed: pip install it" in result.stderr
