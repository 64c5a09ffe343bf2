"""Boxes out of maps that were written by hand."""

import numpy as np
import pytest

from labeler.lidar.pillars.decode import Outputs, decode
from labeler.lidar.pillars.grouping import Grid

GRID = Grid(x_min_m=0.0, y_min_m=-16.0, cell_m=1.0, rows=32, columns=32)  # cells of the output are 2 m wide
CAR_M = (4.0, 2.0, 1.5)


def empty() -> np.ndarray:
    output = np.zeros((Outputs.channels(2), 16, 16), np.float32)
    output[Outputs.HEAT] = -10
    output[Outputs.QUALITY] = 10
    return output


def put(
    output: np.ndarray, row: int, column: int, *, heat: float = 2.0, off_m: tuple[float, float] = (0, 0),
    size_m: tuple[float, float, float] = CAR_M, yaw_deg: float = 0.0, class_logits: tuple[float, float] = (3, 0),
) -> None:  # fmt: skip
    yaw_rad = np.radians(yaw_deg)
    output[Outputs.HEAT, row, column] = heat
    output[Outputs.OFFSET, row, column] = off_m
    output[Outputs.HEIGHT, row, column] = 0.75
    output[Outputs.LOG_SIZE, row, column] = np.log(size_m)
    output[Outputs.AXIS, row, column] = np.sin(2 * yaw_rad), np.cos(2 * yaw_rad)
    output[Outputs.HEADING, row, column] = np.sin(yaw_rad), np.cos(yaw_rad)
    output[Outputs.LOG_STD, row, column] = np.log([0.3, 0.1, 0.05])
    output[Outputs.CLASSES :, row, column] = class_logits


def test_a_box_is_read_as_it_was_written() -> None:
    output = empty()
    put(output, 5, 3, off_m=(0.5, -0.25), yaw_deg=30, class_logits=(0, 2))
    boxes = decode(output, GRID, min_score=0.1)
    np.testing.assert_allclose(boxes.center_m, [[11.5, -9.25, 0.75]])  # row 5 is 10 to 12 m, column 3 is -10 to -8 m
    np.testing.assert_allclose(boxes.size_m, [CAR_M], rtol=1e-6)
    assert np.degrees(boxes.yaw_rad[0]) == pytest.approx(30, abs=1e-3)
    assert boxes.score[0] == pytest.approx(np.sqrt(1 / (1 + np.exp(-2)) / (1 + np.exp(-10))), rel=1e-4)
    assert (boxes.class_index[0], boxes.class_score[0]) == (1, pytest.approx(1 / (1 + np.exp(-2)), rel=1e-4))
    np.testing.assert_allclose(boxes.std, [[0.3, 0.1, 0.05]], rtol=1e-5)


@pytest.mark.parametrize("yaw_deg", [-179, -135, -91, -89, -45, 0, 45, 89, 91, 135, 180])
def test_every_yaw_comes_back(yaw_deg: float) -> None:
    output = empty()
    put(output, 5, 3, yaw_deg=yaw_deg)
    found = float(np.degrees(decode(output, GRID, min_score=0.1).yaw_rad[0]))
    assert abs((found - yaw_deg + 180) % 360 - 180) < 1e-3


@pytest.mark.parametrize(
    ("second", "count"),
    [
        ({"row": 5, "column": 4, "heat": 1.0}, 1),  # a neighbour that is less likely
        (
            {"row": 6, "column": 5, "heat": 1.0, "off_m": (-1.5, -3.5)},
            1,
        ),  # another peak, the same place
        ({"row": 10, "column": 3, "heat": 1.0}, 2),  # 10 m away
        ({"row": 5, "column": 5, "heat": 1.0}, 2),  # parked beside it, 4 m to the left
        ({"row": 10, "column": 3, "heat": -5.0}, 1),  # too unlikely
    ],
)
def test_one_box_for_one_vehicle(second: dict[str, float], count: int) -> None:
    output = empty()
    put(output, 5, 3)
    put(output, **second)  # pyright: ignore[reportArgumentType]
    boxes = decode(output, GRID, min_score=0.1)
    assert len(boxes) == count
    assert (np.diff(boxes.score) <= 0).all()


def test_nothing_gives_no_boxes() -> None:
    boxes = decode(empty(), GRID, min_score=0.1)
    assert boxes.center_m.shape == (0, 3)
    assert boxes.std.shape == (0, 3)
    assert len(boxes.class_index) == 0
