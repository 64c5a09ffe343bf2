import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from labeler.detection.decode import AnchorGrid, anchor_grid, find_candidates, looks_decoded

_ALL = np.ones(2, np.bool_)


def _rows(input_hw: tuple[int, int], *, classes: int = 2) -> NDArray[np.float32]:
    return np.zeros((len(anchor_grid(input_hw)), 5 + classes), np.float32)


def test_grid_is_row_by_row_for_each_stride_in_turn() -> None:
    grid = anchor_grid((32, 64))
    assert len(grid) == 4 * 8 + 2 * 4 + 1 * 2
    assert grid.cell[[0, 1, 8, 31]].tolist() == [[0, 0], [1, 0], [0, 1], [7, 3]]  # stride 8: 8 columns, 4 rows
    assert grid.cell[[32, 36, 40, 41]].tolist() == [[0, 0], [0, 1], [0, 0], [1, 0]]
    assert grid.stride_px[[0, 31, 32, 39, 40], 0].tolist() == [8, 8, 16, 16, 32]


def test_raw_row_becomes_the_box_worked_out_by_hand() -> None:
    rows = _rows((32, 64))
    # Row 10 is column 2, row 1 of stride 8: centre (2 + 0.25, 1 - 0.5) * 8 = (18, 4), size 8 * (2, 0.5) = (16, 4).
    rows[10] = [0.25, -0.5, math.log(2), math.log(0.5), 0.8, 0.1, 0.5]
    found = find_candidates(rows, anchor_grid((32, 64)), decoded=False, min_score=0.05, wanted=_ALL)
    np.testing.assert_allclose(found.xyxy_px, [[10, 2, 26, 6]], rtol=1e-5)
    np.testing.assert_allclose(found.score, [0.4], rtol=1e-6)
    assert found.model_class.tolist() == [1]
    assert (found.xyxy_px.dtype, found.score.dtype) == (np.float32, np.float32)


def test_decoded_row_is_taken_as_it_is() -> None:
    rows = _rows((32, 64))
    rows[10] = [18, 4, 16, 4, 0.8, 0.5, 0.1]
    found = find_candidates(rows, anchor_grid((32, 64)), decoded=True, min_score=0.05, wanted=_ALL)
    assert found.xyxy_px.tolist() == [[10, 2, 26, 6]]
    assert found.model_class.tolist() == [0]


@pytest.mark.parametrize(
    ("objectness", "probabilities", "kept"),
    [
        (0.5, (0.1, 0.0), 1),  # 0.05 is kept
        (0.5, (0.09, 0.0), 0),  # 0.045 is not
        (0.04, (1.0, 0.0), 0),  # objectness alone is too low
        (0.9, (0.5, 0.6), 0),  # the best class is not wanted
    ],
)
def test_only_good_boxes_of_wanted_classes_stay(
    objectness: float, probabilities: tuple[float, float], kept: int
) -> None:
    rows = _rows((32, 32))
    rows[3, 4:] = [objectness, *probabilities]
    wanted = np.array([True, False])
    found = find_candidates(rows, anchor_grid((32, 32)), decoded=False, min_score=0.05, wanted=wanted)
    assert len(found.score) == kept


def test_rows_that_are_not_finite_are_dropped_and_counted() -> None:
    rows = _rows((32, 32))
    rows[:6, 4:] = [0.9, 0.9, 0.0]
    rows[1, 0] = np.nan
    rows[2, 4] = np.nan
    rows[3, 6] = np.nan
    rows[4, 2] = 1000  # exp(1000) is no float
    found = find_candidates(rows, anchor_grid((32, 32)), decoded=False, min_score=0.05, wanted=_ALL)
    assert len(found.score) == 2
    assert found.non_finite == 4
    assert np.isfinite(found.xyxy_px).all()


def _reference(
    rows: NDArray[np.float32], grid: AnchorGrid, *, decoded: bool, min_score: float
) -> list[tuple[list[float], float, int]]:
    """The same, one row at a time, in double precision."""
    boxes: list[tuple[list[float], float, int]] = []
    for row, (column, line), (stride,) in zip(rows.tolist(), grid.cell.tolist(), grid.stride_px.tolist(), strict=True):
        x, y, width, height, objectness, *probabilities = row
        best = max(range(len(probabilities)), key=lambda index: probabilities[index])
        score = objectness * probabilities[best]
        if score < min_score:
            continue
        if not decoded:
            x, y = (x + column) * stride, (y + line) * stride
            width, height = math.exp(width) * stride, math.exp(height) * stride
        boxes.append(([x - width / 2, y - height / 2, x + width / 2, y + height / 2], score, best))
    return boxes


@given(seed=st.integers(0, 2**32 - 1), decoded=st.booleans(), classes=st.integers(1, 5))
def test_equals_the_straightforward_way(seed: int, decoded: bool, classes: int) -> None:
    random = np.random.default_rng(seed)
    grid = anchor_grid((64, 96))
    rows = random.normal(0, 2, (len(grid), 5 + classes)).astype(np.float32)
    rows[:, 4:] = random.random((len(grid), 1 + classes))
    min_score = 0.3000001
    found = find_candidates(rows, grid, decoded=decoded, min_score=min_score, wanted=np.ones(classes, np.bool_))
    expected = _reference(rows, grid, decoded=decoded, min_score=min_score)
    assert found.model_class.tolist() == [best for _, _, best in expected]
    np.testing.assert_allclose(found.score, [score for _, score, _ in expected], rtol=1e-5)
    np.testing.assert_allclose(
        found.xyxy_px, np.array([box for box, _, _ in expected]).reshape(-1, 4), rtol=1e-4, atol=1e-3
    )


@given(seed=st.integers(0, 2**32 - 1), rows_px=st.integers(2, 20), columns_px=st.integers(2, 20))
def test_raw_and_decoded_outputs_are_told_apart(seed: int, rows_px: int, columns_px: int) -> None:
    """Offsets as networks give them: about half a cell, seldom more than two, with sizes of 1/3 to 20 cells."""
    random = np.random.default_rng(seed)
    input_hw = 32 * rows_px, 32 * columns_px
    grid = anchor_grid(input_hw)
    raw = np.zeros((len(grid), 6), np.float32)
    raw[:, :2] = random.normal(0.5, 0.8, (len(grid), 2))
    raw[:, 2:4] = random.uniform(-1, 3, (len(grid), 2))
    decoded = raw.copy()
    decoded[:, :2] = (raw[:, :2] + grid.cell) * grid.stride_px
    decoded[:, 2:4] = np.exp(raw[:, 2:4]) * grid.stride_px
    assert not looks_decoded(raw, grid)
    assert looks_decoded(decoded, grid)


def test_rows_of_nan_do_not_decide() -> None:
    grid = anchor_grid((64, 64))
    decoded = np.zeros((len(grid), 6), np.float32)
    decoded[:, :2] = grid.cell * grid.stride_px
    decoded[:, 2:4] = 10
    decoded[::3, :2] = np.nan
    assert looks_decoded(decoded, grid)
