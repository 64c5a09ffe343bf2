import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from labeler.detection.suppression import suppress
from labeler.geometry.boxes_2d import iou_matrix


def _suppress(
    boxes: list[list[float]], score: list[float], group: list[int], *, iou: float = 0.5, max_candidates: int = 100
) -> list[int]:
    xyxy_px = np.array(boxes, np.float32).reshape(-1, 4)
    rows = suppress(
        xyxy_px, np.array(score, np.float32), np.array(group, np.int32), iou=iou, max_candidates=max_candidates
    )
    return rows.tolist()


@pytest.mark.parametrize(
    ("boxes", "score", "group", "kept"),
    [
        ([], [], [], []),
        ([[0, 0, 10, 10]], [0.5], [0], [0]),
        # IoU 80 / 120 = 0.67: the better one stays
        ([[0, 0, 10, 10], [2, 0, 12, 10]], [0.5, 0.9], [0, 0], [1]),
        # the same boxes in two groups: both stay, the better first
        ([[0, 0, 10, 10], [2, 0, 12, 10]], [0.5, 0.9], [0, 1], [1, 0]),
        # IoU 60 / 140 = 0.43: both stay
        ([[0, 0, 10, 10], [4, 0, 14, 10]], [0.9, 0.5], [0, 0], [0, 1]),
        # a chain: the middle falls to the first, so the last has nobody to fall to
        ([[0, 0, 10, 10], [3, 0, 13, 10], [6, 0, 16, 10]], [0.9, 0.8, 0.7], [0, 0, 0], [0, 2]),
        # equal scores: the earlier one
        ([[0, 0, 10, 10], [0, 0, 10, 10]], [0.5, 0.5], [0, 0], [0]),
    ],
)
def test_better_box_of_a_group_stays(
    boxes: list[list[float]], score: list[float], group: list[int], kept: list[int]
) -> None:
    assert _suppress(boxes, score, group) == kept


def test_only_the_best_candidates_are_looked_at() -> None:
    boxes = [[10.0 * index, 0, 10.0 * index + 5, 5] for index in range(4)]
    assert _suppress(boxes, [0.1, 0.4, 0.2, 0.3], [0] * 4, max_candidates=2) == [1, 3]


def _greedy(
    xyxy_px: NDArray[np.float64], score: NDArray[np.float32], group: NDArray[np.int32], iou: float
) -> list[int]:
    over = (iou_matrix(xyxy_px, xyxy_px) > iou) & (group[:, None] == group[None, :])
    kept: list[int] = []
    for row in np.argsort(-score, kind="stable").tolist():
        if not any(over[row, other] for other in kept):
            kept.append(row)
    return kept


@given(seed=st.integers(0, 2**32 - 1), count=st.integers(0, 60))
def test_equals_the_textbook(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    corner = random.integers(0, 60, (count, 2))
    xyxy_px = np.concatenate([corner, corner + random.integers(5, 40, (count, 2))], axis=1).astype(np.float32)
    score = random.permutation(np.linspace(0.05, 1, count)).astype(np.float32)
    group = random.integers(0, 3, count).astype(np.int32)
    rows = suppress(xyxy_px, score, group, iou=0.45123, max_candidates=1000)
    assert rows.tolist() == _greedy(xyxy_px.astype(np.float64), score, group, 0.45123)
