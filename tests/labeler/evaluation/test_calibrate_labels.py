"""Samples of labels and how well probabilities hold, worked out by hand; the command from sequences to a file."""

import json
from pathlib import Path

import numpy as np
import pytest

from labeler.evaluation.calibrate_labels import fit, main, reliability_of, sample_of_drive, samples_of_text
from labeler.evaluation.types import EvaluationError
from labeler.propagation.probability import FEATURES, probability_of, shipped
from tests.labeler.evaluation.test_label_benchmark import detected, truth, write

LABELER = Path(__file__).parents[3] / "labeler"
SAMPLE = LABELER / "simulation" / "sample" / "turn-at-a-crossing"
WEIGHTS = LABELER / "models" / "weights" / "sim-yolox-nano.onnx"


@pytest.fixture
def sequences(tmp_path: Path) -> Path:
    """A car that is found in 10 frames, with .9; in 10 more the detector says so, .9 too, of a bush; and a van, whose
    labels count for nothing."""
    lines = [truth(frame, 0, "Car", 100) for frame in range(10)] + [truth(frame, 1, "Van", 600) for frame in range(10)]
    found = [detected(frame, x, 0.9) for frame in range(10) for x in (100, 300, 600)]
    return write(tmp_path / "sequences", lines, found)


def test_a_sample_of_a_sequence(sequences: Path) -> None:
    (sample,) = samples_of_text(sequences, ["0000"])
    assert sample.name == "0000"
    assert sample.features.shape == (20, len(FEATURES))
    assert sample.is_right.sum() == 10
    assert sample.confidence.tolist() == pytest.approx([0.9] * 20)
    assert sample.features[:, FEATURES.index("donor_score")].tolist() == pytest.approx([0.9] * 20)
    assert not list(samples_of_text(sequences, ["0001"]))


def test_the_papers_confidence_is_too_sure_here(sequences: Path) -> None:
    """All say .9, and half are right."""
    (sample,) = samples_of_text(sequences, ["0000"])
    found = reliability_of([sample], None)
    assert (found["labels"], found["expected_error"]) == (20, pytest.approx(0.4))


def test_what_was_fitted_says_half(sequences: Path) -> None:
    """Nothing tells the car from the bush but where they are, which no feature knows."""
    samples = list(samples_of_text(sequences, ["0000"]))
    model = fit(samples)
    np.testing.assert_allclose(probability_of(samples[0].features, model), 0.5, atol=0.02)
    assert reliability_of(samples, model)["expected_error"] == pytest.approx(0, abs=0.02)


def test_what_tells_right_from_wrong_is_learned(tmp_path: Path) -> None:
    """Cars of .9 are there, boxes of .5 are on nothing."""
    lines = [truth(frame, 0, "Car", 100) for frame in range(20)]
    found = [detected(frame, 100, 0.9) for frame in range(20)] + [detected(frame, 300, 0.5) for frame in range(20)]
    (sample,) = samples_of_text(write(tmp_path / "sequences", lines, found), ["0000"])
    said = probability_of(sample.features, fit([sample]))
    assert said[sample.is_right].min() > 0.8
    assert said[~sample.is_right].max() < 0.2


def test_a_sample_of_a_drive(tmp_path: Path) -> None:
    """Real labels: those that are likely right are right more often than the others."""
    sample = sample_of_drive(SAMPLE, model=WEIGHTS, workspace=tmp_path)
    assert sample.name == "turn-at-a-crossing, sim-yolox-nano"
    assert len(sample.features) == len(sample.is_right) == len(sample.confidence) > 500
    likely = probability_of(sample.features, shipped()) > 0.6
    assert sample.is_right[likely].mean() > sample.is_right[~likely].mean() + 0.2


def test_a_drive_without_truth_says_so(made_drive: Path, made_model: Path, tmp_path: Path) -> None:
    with pytest.raises(EvaluationError, match="made drive has no true boxes"):
        sample_of_drive(made_drive, model=made_model, workspace=tmp_path)


def run(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> None:
    monkeypatch.setattr("sys.argv", ["calibrate_labels", *map(str, arguments)])
    main()


def test_from_sequences_to_a_file(
    sequences: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "probability.json"
    text = ("--workspace", tmp_path, "--text", sequences, "--text-check", "0000")
    run(monkeypatch, *text, "--text-fit", "0000", "--out", out)
    content = json.loads(out.read_text())
    assert set(content["curves"]) == set(FEATURES) == set(shipped().curves)
    said = capsys.readouterr().out
    assert "fitted on: 20 labels, expected calibration error 0.0" in said
    assert "0000, the paper's confidence: 20 labels, expected calibration error 0.4" in said
    run(monkeypatch, *text)  # the one that ships, checked only
    assert "0000: 20 labels" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--check", "drive"), "need a --model"),
        (("--text-check", "0000"), "need the folder"),
    ],
)
def test_what_is_missing_is_asked_for(
    arguments: tuple[str, ...], said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        run(monkeypatch, "--workspace", "w", *arguments)
    assert said in capsys.readouterr().err
