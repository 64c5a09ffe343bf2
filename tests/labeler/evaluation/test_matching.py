import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from labeler.evaluation.matching import (
    UNMATCHED,
    Pairs,
    fallen_on_dont_care,
    match_greedily,
    overlapping_pairs,
    rank_labels,
)
from labeler.geometry.boxes_2d import iou_matrix


def matched(overlaps: dict[tuple[int, int], float], scores: list[float], truths: int = 3) -> list[int]:
    """What each label takes, from the IoU of each (label, truth) that may match."""
    rows = np.array(list(overlaps), np.intp).reshape(-1, 2)
    iou = np.array(list(overlaps.values()))
    labels = len(scores)
    rank = rank_labels(np.zeros(labels, np.int64), np.array(scores), np.zeros((labels, 4)))
    return match_greedily(Pairs(rows[:, 0], rows[:, 1], iou, iou), rank, truth_count=truths).tolist()


@pytest.mark.parametrize(
    ("overlaps", "scores", "expected"),
    [
        ({}, [0.9], [UNMATCHED]),  # nothing overlaps
        ({(0, 2): 0.6}, [0.9], [2]),  # no other choice
        ({(0, 0): 0.5, (0, 1): 0.7}, [0.9], [1]),  # of two objects the one that overlaps more
        ({(0, 0): 0.5, (1, 0): 0.9}, [0.9, 0.8], [0, UNMATCHED]),  # the surer label chooses first, also if it fits less
        ({(0, 0): 0.9, (1, 0): 0.5}, [0.8, 0.9], [UNMATCHED, 0]),  # in whatever order they stand
        ({(0, 0): 0.9, (1, 0): 0.8, (1, 1): 0.6}, [0.9, 0.8], [0, 1]),  # what is taken leaves the second best
        # greedy, not optimal: 0 takes the object that 1 needs, though it could have had another
        ({(0, 0): 0.9, (0, 1): 0.8, (1, 0): 0.7}, [0.9, 0.8], [0, UNMATCHED]),
        ({(0, 0): 0.6, (0, 1): 0.6}, [0.9], [0]),  # equal overlaps: the first object
    ],
)
def test_who_takes_what(overlaps: dict[tuple[int, int], float], scores: list[float], expected: list[int]):
    assert matched(overlaps, scores) == expected


def test_labels_choose_by_image_then_score_then_box():
    image = np.array([1, 0, 0, 0])
    score = np.array([0.9, 0.5, 0.8, 0.8], np.float32)
    boxes = np.array([[0, 0, 1, 1], [0, 0, 1, 1], [5, 0, 6, 1], [4, 0, 6, 1]], np.float32)
    # image 0: both of .8 before that of .5, the one further left first; then image 1
    assert rank_labels(image, score, boxes).tolist() == [3, 2, 1, 0]


def test_pairs_are_within_an_image_and_overlap():
    a = np.array([[0, 0, 10, 10], [0, 0, 10, 10], [0, 0, 10, 10]], np.float32)
    b = np.array([[0, 0, 10, 5], [10, 0, 20, 10], [5, 5, 15, 15]], np.float32)
    # images 0, 1 and 3; the second b only touches, image 3 has no b
    pairs = overlapping_pairs(np.array([1, 0, 3]), a, np.array([0, 0, 1]), b)
    assert list(zip(pairs.a.tolist(), pairs.b.tolist(), strict=True)) == [(0, 2), (1, 0)]
    assert pairs.iou == pytest.approx([25 / 175, 0.5])
    assert pairs.inside == pytest.approx([0.25, 0.5])


@pytest.mark.parametrize(
    ("iou", "inside", "min_iou", "falls"),
    [
        (0.5, 0.6, 0.5, True),  # as a hit would
        (0.1, 0.5, 0.5, True),  # a small label inside a large region: half of it is enough
        (0.3, 0.4, 0.5, False),  # neither
        (0.3, 0.4, 0.25, True),  # by the IoU that is asked
    ],
)
def test_falling_on_a_region_not_to_care_about(iou: float, inside: float, min_iou: float, falls: bool):
    zero = np.zeros(1, np.intp)
    pairs = Pairs(zero, zero, np.array([iou]), np.array([inside]))
    assert fallen_on_dont_care(pairs, label_count=2, min_iou=min_iou).tolist() == [falls, False]


BOXES = st.integers(0, 9).flatmap(lambda count: arrays(np.int64, (count, 4), elements=st.integers(0, 12)))


def as_boxes(corners: np.ndarray) -> np.ndarray:
    """Boxes with an area from any four whole numbers."""
    low = np.minimum(corners[:, :2], corners[:, 2:])
    return np.concatenate([low, np.maximum(corners[:, :2], corners[:, 2:]) + 1], axis=1).astype(np.float32)


@given(BOXES, BOXES)
def test_overlaps_equal_those_of_the_full_matrix(a: np.ndarray, b: np.ndarray):
    a, b = as_boxes(a), as_boxes(b)
    pairs = overlapping_pairs(np.zeros(len(a), np.int64), a, np.zeros(len(b), np.int64), b)
    matrix = np.zeros((len(a), len(b)))
    matrix[pairs.a, pairs.b] = pairs.iou
    assert matrix == pytest.approx(iou_matrix(a, b), abs=1e-6)


@given(BOXES, BOXES, st.randoms(use_true_random=False))
def test_the_shortcut_gives_what_the_plain_loop_gives(a: np.ndarray, b: np.ndarray, random):
    a, b = as_boxes(a), as_boxes(b)
    score = np.array([random.choice([0.2, 0.5, 0.9]) for _ in a])
    rank = rank_labels(np.zeros(len(a), np.int64), score, a)
    pairs = overlapping_pairs(np.zeros(len(a), np.int64), a, np.zeros(len(b), np.int64), b)
    expected, free = [UNMATCHED] * len(a), set(range(len(b)))
    iou = np.zeros((len(a), len(b)))
    iou[pairs.a, pairs.b] = pairs.iou
    for label in np.argsort(rank):
        best = max(sorted(free), key=lambda truth: iou[label, truth], default=None)
        if best is not None and iou[label, best] > 0:
            expected[label] = best
            free.remove(best)
    assert match_greedily(pairs, rank, truth_count=len(b)).tolist() == expected
