"""Samples of boxes and what a threshold does to them, worked out by hand; the command from sequences to a file."""

import json
from pathlib import Path

import numpy as np
import pytest

from labeler.evaluation.calibrate_trust import fit, main, precision_and_recall, samples_of_drive, samples_of_text
from labeler.evaluation.counting import FALSE_LABEL, HIT
from labeler.evaluation.types import EvaluationError
from labeler.tracking.trust import FEATURES, shipped
from tests.labeler.evaluation.test_label_benchmark import detected, truth, write

LABELER = Path(__file__).parents[3] / "labeler"
SAMPLE = LABELER / "simulation" / "sample" / "turn-at-a-crossing"
WEIGHTS = LABELER / "models" / "weights" / "sim-yolox-nano.onnx"


@pytest.fixture
def sequences(tmp_path: Path) -> Path:
    """Twenty frames of a car that is found in all; half of the time it is gone while the detector still says so, .3."""
    lines = [truth(frame, 0, "Car", 100) for frame in range(10)]
    found = [detected(frame, 100, 0.9 if frame < 10 else 0.3) for frame in range(20)]
    return write(tmp_path / "sequences", lines, found)


def test_a_sample_of_a_sequence(sequences: Path) -> None:
    (sample,) = samples_of_text(sequences, ["0000"])
    assert sample.objects == 10
    assert sample.features.shape == (20, len(FEATURES))
    assert sample.features[:, FEATURES.index("relative_score")].tolist() == pytest.approx([1.0] * 10 + [1 / 3] * 10)
    for outcome in sample.outcome.values():
        assert outcome.tolist() == [HIT] * 10 + [FALSE_LABEL] * 10
    assert sample.is_donor.tolist() == [True] * 10 + [False] * 10


def test_a_threshold_takes_what_is_not_trusted_and_never_a_donor(sequences: Path) -> None:
    samples = list(samples_of_text(sequences, ["0000"]))
    model = fit(samples)
    assert precision_and_recall(samples, model, 0.0) == [(0.5, 1.0)] * 2
    assert precision_and_recall(samples, model, 1.0) == [(1.0, 1.0)] * 2


def test_a_simulated_drive_counts_half(tmp_path: Path) -> None:
    samples = list(samples_of_drive(SAMPLE, models=[WEIGHTS], workspace=tmp_path))
    assert len({sample.name for sample in samples}) == len(samples) == 4
    assert sum(sample.weight for sample in samples) == pytest.approx(0.5)
    assert sum(np.count_nonzero(sample.outcome[0.5] == HIT) for sample in samples) > 50


def test_a_drive_without_truth_says_so(made_drive: Path, made_model: Path, tmp_path: Path) -> None:
    with pytest.raises(EvaluationError, match="made drive has no true boxes"):
        next(samples_of_drive(made_drive, models=[made_model], workspace=tmp_path))


def test_from_sequences_to_a_file(
    sequences: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "trust.json"
    arguments = ["--workspace", tmp_path, "--text", sequences, "--text-fit", "0000", "--text-check", "0000"]
    monkeypatch.setattr("sys.argv", ["calibrate_trust", *map(str, arguments), "--out", str(out)])
    main()
    assert set(json.loads(out.read_text())["curves"]) == set(FEATURES) == set(shipped().curves)
    assert "other sequences" in capsys.readouterr().out
    assert np.isfinite(json.loads(out.read_text())["bias"])
