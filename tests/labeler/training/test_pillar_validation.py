"""The figures of a report, from boxes whose worth is known."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from labeler.lidar.pillars.decode import PillarBoxes
from labeler.training import pillar_validation
from labeler.training.clouds import PILLAR_CLASSES, DirectionSweep
from labeler.training.errors import TrainingError
from labeler.training.pillar_validation import PillarReport, validate_pillars
from tests.labeler.training.made_clouds import CAR_M, direction

SWEEP = direction((15, 3, 20), (30, -6, -90), (55, 0, 0), clutter=0)
NEAR, FAR, TOO_FAR = (15.0, 3.0, 20.0), (30.0, -6.0, -90.0), (55.0, 0.0, 0.0)


class KnownNetwork:
    """Finds what it is told to find, everywhere."""

    painted, class_names = True, PILLAR_CLASSES

    def __init__(self, boxes: list[tuple[tuple[float, float, float], float, int]]) -> None:
        """Boxes of a car's size: x, y and yaw in degrees, score, class."""
        places = np.array([place for place, _, _ in boxes]).reshape(-1, 3)
        count = len(boxes)
        self._found = PillarBoxes(
            center_m=np.column_stack([places[:, :2], np.full(count, CAR_M[2] / 2)]),
            size_m=np.tile(CAR_M, (count, 1)),
            yaw_rad=np.radians(places[:, 2]),
            score=np.array([score for _, score, _ in boxes], np.float64),
            class_index=np.array([number for _, _, number in boxes], np.intp),
            class_score=np.ones(count),
            std=np.tile([0.5, 0.5, 0.1], (count, 1)),
        )

    def find(self, cloud: NDArray[np.float32], *, min_score: float) -> PillarBoxes:
        return self._found


def report(
    monkeypatch: pytest.MonkeyPatch, sweep: DirectionSweep, boxes: list[tuple[tuple[float, float, float], float, int]]
) -> PillarReport:
    monkeypatch.setattr(pillar_validation, "PillarModel", lambda _: KnownNetwork(boxes))
    monkeypatch.setattr(pillar_validation, "open_drive", lambda folder: folder)
    monkeypatch.setattr(pillar_validation, "direction_sweeps", lambda *_: [sweep])
    return validate_pillars(Path("model.onnx"), [Path("drive")], None, lambda: None)  # pyright: ignore[reportArgumentType]


BESIDE = (15.3, 3.4, 20.0)  # .5 m off: exactly one deviation
ELSEWHERE = (20.0, 10.0, 0.0)


@pytest.mark.parametrize(
    ("asked", "boxes", "count", "precision_area", "right_class"),
    [
        ([1, 1, 1], [(NEAR, 0.9, 0), (FAR, 0.8, 0)], 2, 1.0, 1.0),  # the one 55 m away is not asked for
        ([1, 1, 1], [(NEAR, 0.9, 0), (FAR, 0.8, 0), (TOO_FAR, 0.95, 0)], 2, 1.0, 1.0),  # nor is it forbidden
        ([1, 1, 1], [(NEAR, 0.9, 1), (FAR, 0.8, 0)], 2, 1.0, 0.5),  # called a truck
        ([1, 1, 1], [(NEAR, 0.9, 0)], 2, 51 / 101, 1.0),  # one missed: recalls 0 to .5
        ([1, 1, 1], [(NEAR, 0.9, 0), (FAR, 0.8, 0), (NEAR, 0.85, 0)], 2, (51 + 50 * 2 / 3) / 101, 1.0),  # found twice
        ([0, 1, 1], [(NEAR, 0.9, 0), (FAR, 0.8, 0)], 1, 1.0, 1.0),  # on one that is not asked for
        ([1, 1, 1], [(ELSEWHERE, 0.9, 0), (NEAR, 0.8, 0), (FAR, 0.7, 0)], 2, 1.0, 1.0),  # holds no point that is seen
        ([1, 1, 1], [], 2, 0.0, None),
    ],
)
def test_figures_of_known_boxes(
    monkeypatch: pytest.MonkeyPatch, asked: list[int], boxes: list[tuple[tuple[float, float, float], float, int]],
    count: int, precision_area: float, right_class: float | None,
) -> None:  # fmt: skip
    found = report(monkeypatch, replace(SWEEP, asked=np.array(asked, np.bool_)), boxes).results[0]
    assert (found.name, found.truth_count) == ("within 50 m", count)
    assert found.average_precision == pytest.approx(precision_area)
    assert found.right_class == right_class


def test_how_far_off_is_told_in_metres_and_deviations(monkeypatch: pytest.MonkeyPatch) -> None:
    found = report(monkeypatch, SWEEP, [(BESIDE, 0.9, 0), (FAR, 0.8, 0)])
    near = {result.name: result for result in found.results}["10 to 20 m"]
    assert near.median_off_m == pytest.approx(0.5, abs=1e-5)
    assert found.results[0].median_off_m == pytest.approx(0.25, abs=1e-5)
    assert found.results[0].within_deviation in (0.5, 1.0)  # the one that is exactly a deviation off may be either
    assert found.directions == 1


def test_a_false_box_counts_where_it_stands(monkeypatch: pytest.MonkeyPatch) -> None:
    turned = (15.0, 3.0, 110.0)  # across the car: an IoU of a quarter
    found = report(monkeypatch, SWEEP, [(turned, 0.9, 0), (FAR, 0.8, 0)])
    by_name = {result.name: result.average_precision for result in found.results}
    assert by_name["10 to 20 m"] == 0
    assert by_name["30 to 40 m"] == 1
    assert by_name["within 50 m"] == pytest.approx(0.5 * 51 / 101)


def test_no_direction_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pillar_validation, "PillarModel", lambda _: KnownNetwork([]))
    with pytest.raises(TrainingError, match="nothing to find"):
        validate_pillars(Path("model.onnx"), [], None, lambda: None)  # pyright: ignore[reportArgumentType]
