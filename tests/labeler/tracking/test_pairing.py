"""Candidates and pairs: by hand, and against all pairs by the Hungarian method."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from labeler.geometry.boxes_2d import iou_matrix
from labeler.tracking import pairing
from labeler.tracking.pairing import Candidates, overlapping, pair_in_turn, pair_off


def candidates(*rows: tuple[int, int, float]) -> Candidates:
    table = np.array(rows, np.float64).reshape(-1, 3)
    return Candidates(table[:, 0].astype(np.intp), table[:, 1].astype(np.intp), table[:, 2])


def pairs(found: tuple[np.ndarray, np.ndarray]) -> dict[int, int]:
    return dict(zip(found[0].tolist(), found[1].tolist(), strict=True))


@pytest.mark.parametrize(
    ("offered", "expected"),
    [
        (candidates(), {}),  # nothing to pair
        (candidates((0, 1, 0.2), (3, 0, 0.9)), {0: 1, 3: 0}),  # none competes
        (candidates((0, 0, 0.9), (1, 0, 0.8)), {0: 0}),  # two for one
        (candidates((0, 0, 0.5), (0, 1, 0.6), (1, 1, 0.9)), {0: 0, 1: 1}),  # .5 + .9 beats .6 alone
        (candidates((0, 0, 0.9), (0, 1, 0.8), (1, 0, 0.8)), {0: 1, 1: 0}),  # .8 + .8 beats the best single pair
        (candidates((0, 0, 0.9), (0, 1, 0.4), (1, 0, 0.5)), {0: 0}),  # .9 is as much as .4 + .5
        (candidates((0, 0, 0.5), (0, 1, 0.5), (1, 1, 0.5)), {0: 0, 1: 1}),  # equals
    ],
)
def test_pairs_by_hand(offered: Candidates, expected: dict[int, int]) -> None:
    assert pairs(pair_off(offered, a_count=4, b_count=4)) == expected


cell = st.tuples(st.integers(0, 7), st.integers(0, 7), st.floats(0.01, 1.0))


@settings(deadline=None)
@given(st.lists(cell, unique_by=lambda row: row[:2], max_size=30), st.booleans())
def test_the_total_is_the_largest(rows: list[tuple[int, int, float]], grouped: bool) -> None:
    """Whether solved at once or group by group."""
    matrix = np.zeros((8, 8))
    for a, b, weight in rows:
        matrix[a, b] = weight
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pairing, "_DENSE_CELLS", 0 if grouped else 10_000)
        found = pair_off(candidates(*rows), a_count=8, b_count=8)
    assert len(set(found[0].tolist())) == len(set(found[1].tolist())) == len(found[0])
    assert matrix[found].sum() == pytest.approx(matrix[linear_sum_assignment(matrix, maximize=True)].sum())


def test_a_very_large_group_is_paired_greedily(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pairing, "_DENSE_CELLS", 0)
    monkeypatch.setattr(pairing, "_HUNGARIAN_CELLS", 0)
    offered = candidates((0, 0, 0.9), (0, 1, 0.8), (1, 0, 0.8), (2, 2, 0.3), (2, 3, 0.2))
    assert pairs(pair_off(offered, a_count=3, b_count=4)) == {0: 0, 2: 2}


@pytest.mark.parametrize(
    ("compare_all", "at_once"),
    [
        (10_000, 10_000),  # all with all
        (0, 10_000),  # only those beside each other
        (0, 100),  # so many of these that they are looked at in parts
        (0, 1),  # less than one row has
    ],
)
def test_candidates_are_the_pairs_that_overlap_enough(
    compare_all: int, at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also boxes that begin or end at the same place, or are one and the same."""
    monkeypatch.setattr(pairing, "_COMPARE_ALL_CELLS", compare_all)
    monkeypatch.setattr(pairing, "_CELLS_AT_ONCE", at_once)
    random = np.random.default_rng(0)
    corners = random.integers(0, 100, (2, 70, 2)).astype(np.float64)
    a, b = np.concatenate([corners, corners + random.integers(5, 40, corners.shape)], axis=2)
    b[:5] = a[:5]
    found = overlapping(a[:, :2].T, a[:, 2:].T, b[:, :2].T, b[:, 2:].T, min_iou=0.2)
    order = np.lexsort((found.b, found.a))
    iou = iou_matrix(a, b)
    expected = np.argwhere(iou >= 0.2)
    np.testing.assert_array_equal(np.stack([found.a, found.b], axis=1)[order], expected)
    np.testing.assert_allclose(found.weight[order], iou[tuple(expected.T)])


@pytest.mark.parametrize(
    ("rows", "turns", "expected"),
    [
        # the first turn chooses, though the second has more to offer; row 1 of a gets what is left
        ([(0, 0, 0.2), (1, 0, 0.9), (1, 1, 0.3)], [0, 1, 1], {0: 0, 1: 1}),
        # within a turn the largest total counts
        ([(0, 0, 0.9), (0, 1, 0.8), (1, 0, 0.8)], [1, 1, 1], {0: 1, 1: 0}),
        # who has no rival needs no turn
        ([(0, 0, 0.9), (1, 1, 0.1), (2, 0, 0.8)], [0, 3, 2], {0: 0, 1: 1}),
    ],
)
def test_turns_by_hand(rows: list[tuple[int, int, float]], turns: list[int], expected: dict[int, int]) -> None:
    assert pairs(pair_in_turn(candidates(*rows), np.array(turns), a_count=3, b_count=3)) == expected


@pytest.mark.parametrize(("a_count", "b_count"), [(0, 0), (0, 3), (3, 0)])
def test_no_boxes_on_one_side(a_count: int, b_count: int) -> None:
    found = overlapping(*np.zeros((2, 2, a_count)), *np.ones((2, 2, b_count)), min_iou=0.1)
    assert pairs(pair_off(found, a_count=a_count, b_count=b_count)) == {}
