"""The benchmark of labels: counts worked out by hand on a few cars, clear errors, and the figures on real sequences."""

from pathlib import Path

import numpy as np
import pytest

from labeler.evaluation.label_benchmark import LabelRow
from labeler.evaluation.label_benchmark import benchmark_labels as benchmark_sequences
from labeler.evaluation.text_sequences import read_sequences
from labeler.evaluation.types import EvaluationConfig, EvaluationError

CALIBRATION = """P2: 700 0 600 0 0 700 180 0 0 0 1 0
R0_rect: 1 0 0 0 1 0 0 0 1
Tr_velo_to_cam: 0 -1 0 0 0 0 -1 0 1 0 0 0
"""


def benchmark_labels(root: Path) -> list[LabelRow]:
    return benchmark_sequences(read_sequences(root, config=EvaluationConfig()))


def truth(frame: int, track: int, category: str, x: float, z_m: float = 20) -> str:
    return f"{frame} {track} {category} 0 0 0 {x} 100 {x + 40} 130 1.5 1.6 4 0 1.6 {z_m} 0"


def detected(frame: int, x: float, score: float) -> str:
    return f"{frame},{x},100,{x + 40},130,{score}"


def write(root: Path, truth_lines: list[str], detection_lines: list[str]) -> Path:
    for folder, text in (
        ("label_02", "\n".join(truth_lines)),
        ("calib", CALIBRATION),
        ("det_some", "\n".join(detection_lines)),
    ):
        (root / folder).mkdir(parents=True, exist_ok=True)
        (root / folder / "0000.txt").write_text(text + "\n")
    return root


def test_counts_by_hand(tmp_path: Path) -> None:
    """Ten frames of a near car, sure but in frame 4, a far car that is seen once, a van, and a tram."""
    lines = [truth(frame, 0, "Car", 100) for frame in range(10)] + [truth(0, 1, "Car", 300, 50)]
    lines += [truth(0, 2, "Van", 500), truth(0, 3, "Tram", 700), truth(0, 4, "Car", 900, 90)]
    found = [detected(frame, 100, 0.5 if frame == 4 else 0.9) for frame in range(10)]
    found += [detected(0, x, 0.9) for x in (300, 500, 700, 900)]
    none, baseline, ours = benchmark_labels(write(tmp_path, lines, found))
    # the near car in 9 of 10 frames and the far one; the tram is false; van and the car at 90 m are neither
    assert (none["p25"], none["r25"], none["r25_far"]) == (round(10 / 11, 5), round(10 / 11, 5), 1)
    assert none["hota"] is None
    # tracking finds the near car in frame 4 as well
    for row in (baseline, ours):
        assert (row["p25"], row["r25"], row["p50"], row["r50"]) == (round(11 / 12, 5), 1, round(11 / 12, 5), 1)
        assert row["idf1"] == round(2 * 11 / (11 + 12), 5)


@pytest.mark.parametrize(
    ("file", "text", "said"),
    [
        ("det_some/0000.txt", "0,1,2,3,4\n", "needs one folder det_"),  # no rows of six fields anywhere
        ("det_some/0000.txt", "0,1,2,30,40,0.5\n1,2,3\n", "line 2 has 3 fields"),
        ("det_some/0000.txt", "0,1,2,30,40,0.5\n1,2,3,x,4,5\n", "line 2 holds something that is no number"),
        ("det_some/0000.txt", "-1,1,2,30,40,0.5\n", "line 1 must begin with a frame number"),
        ("label_02/0000.txt", "zero 1 Car\n", "line 1 must begin with a frame number"),
        ("label_02/0000.txt", "0 1 Car\n", "line 1 has 3 fields"),
        ("label_02/0000.txt", "\x00\xff", "0000.txt"),
    ],
)
def test_broken_files_are_named(tmp_path: Path, file: str, text: str, said: str) -> None:
    root = write(tmp_path, [truth(0, 0, "Car", 100)], [detected(0, 100, 0.9)])
    (root / file).write_text(text, encoding="latin-1")
    with pytest.raises(Exception, match=said) as caught:
        benchmark_labels(root)
    assert "0000.txt" in str(caught.value) or "det_" in str(caught.value)


def test_missing_files_are_named(tmp_path: Path) -> None:
    with pytest.raises(EvaluationError, match="needs one folder"):
        benchmark_labels(tmp_path)
    root = write(tmp_path, [truth(0, 0, "Car", 100)], [detected(0, 100, 0.9)])
    (root / "calib" / "0000.txt").unlink()
    with pytest.raises(EvaluationError, match=r"calib/0000.txt is missing"):
        benchmark_labels(root)


@pytest.mark.real_drive
def test_beats_the_paper_on_real_detections(kitti_tracking_text: Path) -> None:
    """All five at once, as the project asks for: precision, recall, recall of what is far, at both overlaps."""
    _, baseline, ours = benchmark_labels(kitti_tracking_text)
    figures = [(row["p25"], row["r25"], row["r25_far"], row["p50"], row["r50"]) for row in (ours, baseline)]
    gain = np.subtract(*np.array(figures, np.float64))
    assert (gain >= [0.015, 0.010, 0, 0.015, 0.010]).all()
