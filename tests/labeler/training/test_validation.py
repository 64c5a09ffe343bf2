"""The figures of a report, from answers whose worth is known."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from labeler.detection.types import Detections
from labeler.segmentation import SegmentationScores
from labeler.training import detector_validation
from labeler.training.detector_validation import SCOPES, validate_detector
from labeler.training.segmentation_validation import confusion, likeliest, results_of
from tests.labeler.training.test_pictures import make_drive


class KnownDetector:
    """Says what it is told to say, for every image."""

    class_names = ("car", "motorcycle", "truck")

    def __init__(self, boxes: Sequence[tuple[float, ...]]) -> None:
        """Boxes of class, score, x1, y1, x2, y2."""
        rows = np.array(boxes, np.float32).reshape(-1, 6)
        self._found = Detections(rows[:, 2:], rows[:, 1], rows[:, 0].astype(np.int16))

    def detect(self, images: Sequence[NDArray[np.uint8]]) -> list[Detections]:
        return [self._found for _ in images]


# As they lie in the drive that is made: the motorcycle is 60 m away, the trailer is of no class.
CAR, MOTORCYCLE, THIN_CAR, TRUCK = (10, 10, 40, 30), (50, 10, 60, 30), (70, 10, 73, 30), (10, 40, 60, 50)
RIGHT = [(0, 0.9, *CAR), (1, 0.85, *MOTORCYCLE), (0, 0.7, *THIN_CAR), (2, 0.9, *TRUCK)]
FALSE = (0, 0.95, 80, 30, 95, 39)
LONGER, BOTH = "within 40 m, longer side above 12 px", "within 40 m, both sides above 12 px"


@pytest.mark.parametrize(
    ("boxes", "scope", "count", "precision_area", "any_class", "precision", "recall"),
    [
        # The car, the thin car (3 x 20) and the truck (50 x 10) count; the motorcycle is too far: its box is no error.
        (RIGHT, LONGER, 3, 1.0, 1.0, 1.0, 2 / 3),
        # Both sides above 12: the car alone; what falls on the others is no error.
        (RIGHT, BOTH, 1, 1.0, 1.0, 1.0, 1.0),
        # One false box that is surer than the right one: precision is one half everywhere.
        ([*RIGHT, FALSE], BOTH, 1, 0.5, 0.5, 0.5, 1.0),
        # The truck called car, and that surest: an error, except where classes are not compared.
        ([(0, 0.99, *TRUCK), (0, 0.9, *CAR)], LONGER, 3, 0.5 * 34 / 101, 67 / 101, 0.5, 1 / 3),
        ([], LONGER, 3, 0.0, 0.0, None, 0.0),
    ],
)
def test_figures_of_known_answers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, boxes: list[tuple[float, ...]], scope: str, count: int,
    precision_area: float, any_class: float, precision: float | None, recall: float,
) -> None:  # fmt: skip
    def opened(*_: object, **__: object) -> KnownDetector:
        return KnownDetector(boxes)

    monkeypatch.setattr(detector_validation, "open_detector", opened)
    report = validate_detector(tmp_path / "model.onnx", [make_drive(tmp_path / "drive")], lambda: None)
    found = {result.name: result for result in report.results}[scope]

    assert (report.images, found.truth_count) == (1, count)
    assert found.average_precision == pytest.approx(precision_area)
    assert found.average_precision_any_class == pytest.approx(any_class)
    assert found.precision_at_confidence == (None if precision is None else pytest.approx(precision))
    assert found.recall_at_confidence == pytest.approx(recall)


def test_scopes_say_what_they_count() -> None:
    main = SCOPES["within 40 m, longer side above 12 px"]
    assert (main.max_distance_m, main.longer_side_px, main.shorter_side_px) == (40.0, 12.0, 0.0)
    assert SCOPES["bus, within 40 m, longer side above 12 px"].class_name == "bus"


def test_confusion_counts_pixels_and_iou_follows() -> None:
    truth = np.array([[1, 1, 4, 4]], np.uint8)
    answer = np.array([[1, 4, 4, 4]])

    results = {result.name: result for result in results_of(confusion(truth, answer))}

    assert results["road"].iou == pytest.approx(1 / 2)  # one of two, and nothing else called so
    assert results["vehicle"].iou == pytest.approx(2 / 3)
    assert results["building"].iou is None
    assert results["vehicle"].truth_share == pytest.approx(0.5)


def test_scores_between_two_cells_go_over_in_the_middle() -> None:
    scores = np.zeros((2, 1, 2), np.uint8)
    scores[0, 0, 0] = scores[1, 0, 1] = 255

    answer = likeliest(SegmentationScores(("road", "vehicle"), scores, 4.0, (8, 4)))

    assert answer.tolist() == [[0, 0, 0, 0, 1, 1, 1, 1]] * 4
