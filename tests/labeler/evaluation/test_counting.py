import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labeler.drive.types import Truth, TruthBoxes2D
from labeler.evaluation.categories import CLASSES
from labeler.evaluation.counting import Counts, Labels2D, Tally
from labeler.evaluation.matching import overlapping_pairs
from labeler.evaluation.truth import TruthTable, prepare_truth
from labeler.evaluation.types import EvaluationConfig

Box = tuple[float, float, float, float]
TruthRow = tuple[Box, str, float]
"""A box, a category, and the distance in metres."""
LabelRow = tuple[Box, str, float]
"""A box, a class, and the score."""

CAR: Box = (0, 0, 10, 10)
SHIFTED: Box = (5, 0, 15, 10)  # IoU with CAR: 50 / 150 = .33
ELSEWHERE: Box = (50, 50, 60, 60)


def table(truth: list[TruthRow]) -> TruthTable:
    boxes = TruthBoxes2D(
        frame_index=np.zeros(len(truth), np.int32),
        camera=("front",) * len(truth),
        track_uuid=tuple(str(row) for row in range(len(truth))),
        category=tuple(category for _, category, _ in truth),
        xyxy_px=np.array([box for box, _, _ in truth], np.float32).reshape(-1, 4),
        distance_m=np.array([distance for _, _, distance in truth], np.float32),
    )
    found = prepare_truth(Truth(boxes, None), ("front",), EvaluationConfig())
    assert found is not None
    return found


def labels_of(labels: list[LabelRow]) -> Labels2D:
    return Labels2D(
        image=np.zeros(len(labels), np.int64),
        camera=np.zeros(len(labels), np.int16),
        xyxy_px=np.array([box for box, _, _ in labels], np.float32).reshape(-1, 4),
        label_class=np.array([CLASSES.index(name) if name in CLASSES else -1 for _, name, _ in labels], np.int16),
        score=np.array([score for _, _, score in labels], np.float32),
    )


def count(
    truth: list[TruthRow], labels: list[LabelRow], *, iou: float = 0.5, confidence: float = 0.8, aware: bool = True
) -> Counts:
    true = table(truth)
    tally = Tally(true, [("whole", iou)], compare_classes=aware)
    rows = labels_of(labels)
    pairs = overlapping_pairs(rows.image, rows.xyxy_px, true.image, true.whole_px)
    tally.add(rows, slice(0, len(true)), {"whole": pairs})
    return tally.counts(("whole", iou), confidence=confidence)


@pytest.mark.parametrize(
    ("truth", "labels", "expected"),
    [
        ([(CAR, "car", 10)], [(CAR, "car", 0.9)], Counts(1, 0, 0)),  # a hit
        ([(CAR, "car", 10)], [], Counts(0, 0, 1)),  # a miss
        ([], [(CAR, "car", 0.9)], Counts(0, 1, 0)),  # a false label
        ([(CAR, "car", 10)], [(CAR, "car", 0.8)], Counts(1, 0, 0)),  # just sure enough
        ([(CAR, "car", 10)], [(CAR, "car", 0.79)], Counts(0, 0, 1)),  # not sure enough: as if it were not there
        ([(CAR, "car", 10)], [(CAR, "car", np.nan)], Counts(0, 0, 1)),  # a label without a score
        ([(CAR, "car", 10)], [(SHIFTED, "car", 0.9)], Counts(0, 1, 1)),  # too little overlap: false, and a miss
        ([(CAR, "car", 10)], [(CAR, "truck", 0.9)], Counts(0, 1, 1)),  # another class: false, and a miss
        ([(CAR, "car", 10)], [(CAR, "person", 0.9)], Counts(0, 0, 1)),  # people are not counted
        ([(CAR, "PEDESTRIAN", 10)], [], Counts(0, 0, 0)),  # neither as truth
        ([(CAR, "PEDESTRIAN", 10)], [(CAR, "car", 0.9)], Counts(0, 1, 0)),  # but a person that is called car is false
        ([(CAR, "car", 10)], [(CAR, "car", 0.9), (CAR, "car", 0.85)], Counts(1, 1, 0)),  # one hit for one object
        ([(CAR, "car", 81)], [], Counts(0, 0, 0)),  # too far: no miss
        ([(CAR, "car", 81)], [(CAR, "car", 0.9)], Counts(0, 0, 0)),  # no hit, and no false label
        ([(CAR, "car", 81)], [(CAR, "car", 0.9), (CAR, "bus", 0.9)], Counts(0, 0, 0)),  # it takes any number and class
        # half of the label lies in a region not to care about, though the IoU is small
        ([((0, 0, 100, 10), "DontCare", np.nan)], [((95, 0, 105, 10), "car", 0.9)], Counts(0, 0, 0)),
        ([((0, 0, 100, 10), "DontCare", np.nan)], [((96, 0, 106, 10), "car", 0.9)], Counts(0, 1, 0)),  # less than half
        # a hit comes first: the object behind is too far, the one in front is found
        ([(CAR, "car", 81), (CAR, "car", 10)], [(CAR, "car", 0.9)], Counts(1, 0, 0)),
        # the second label finds its object taken, and falls on the far one
        ([(CAR, "car", 81), (CAR, "car", 10)], [(CAR, "car", 0.9), (CAR, "car", 0.85)], Counts(1, 0, 0)),
        # a label that is not sure enough takes nothing from one that is
        ([(CAR, "car", 10)], [(CAR, "car", 0.7), ((0, 0, 10, 9), "car", 0.9)], Counts(1, 0, 0)),
    ],
)
def test_each_rule(truth: list[TruthRow], labels: list[LabelRow], expected: Counts):
    assert count(truth, labels) == expected


def test_a_smaller_iou_finds_more():
    assert count([(CAR, "car", 10)], [(SHIFTED, "car", 0.9)], iou=0.25) == Counts(1, 0, 0)


def test_classes_need_not_be_compared():
    assert count([(CAR, "bus", 10)], [(CAR, "car", 0.9)], aware=False) == Counts(1, 0, 0)


def test_shares():
    assert (Counts(3, 1, 2).precision, Counts(3, 1, 2).recall) == (0.75, 0.6)
    assert (Counts(0, 0, 2).precision, Counts(0, 1, 0).recall) == (None, None)


def test_one_camera_alone_and_some_objects_alone():
    true = TruthTable(
        image=np.array([0, 1]),
        camera=np.array([0, 1], np.int16),
        object_id=np.array([0, 1], np.int32),
        category_class=np.zeros(2, np.int16),
        counted=np.ones(2, np.bool_),
        whole_px=np.array([CAR, CAR], np.float32),
        visible_px=None,
        distance_m=np.array([5, 50], np.float32),
        visible_share=None,
    )
    labels = Labels2D(
        image=np.array([1, 1]),
        camera=np.array([1, 1], np.int16),
        xyxy_px=np.array([CAR, ELSEWHERE], np.float32),
        label_class=np.zeros(2, np.int16),
        score=np.array([0.9, 0.95], np.float32),
    )
    criterion = ("whole", 0.5)
    tally = Tally(true, [criterion], compare_classes=True)
    part = slice(1, 2)  # the truth of image 1
    pairs = overlapping_pairs(labels.image, labels.xyxy_px, true.image[part], true.whole_px[part])
    tally.add(labels, part, {"whole": pairs})
    assert tally.counts(criterion, confidence=0.8) == Counts(1, 1, 1)
    assert tally.counts(criterion, confidence=0.8, cameras=[0]) == Counts(0, 0, 1)
    assert tally.counts(criterion, confidence=0.8, cameras=[1]) == Counts(1, 1, 0)
    assert tally.counts(criterion, confidence=0.92) == Counts(0, 1, 2)
    assert tally.found(criterion, true.distance_m < 10, confidence=0.8) == (0, 1)
    score, is_hit = tally.judged_scores(criterion)
    assert sorted(zip(score.round(2).tolist(), is_hit.tolist(), strict=True)) == [
        (pytest.approx(0.9, abs=1e-6), True),
        (pytest.approx(0.95, abs=1e-6), False),
    ]


SIDES = st.tuples(st.integers(0, 12), st.integers(0, 12), st.integers(1, 8), st.integers(1, 8))
BOX = SIDES.map(lambda side: (float(side[0]), float(side[1]), float(side[0] + side[2]), float(side[1] + side[3])))
TRUTHS = st.lists(
    st.tuples(BOX, st.sampled_from(["car", "truck", "DontCare"]), st.sampled_from([10.0, 90.0])), max_size=7
)
LABELS = st.lists(
    st.tuples(BOX, st.sampled_from(["car", "truck", "person"]), st.sampled_from([0.5, 0.8, 0.9, 0.95])), max_size=7
)
IOUS = st.sampled_from([0.1, 0.25, 0.5, 0.75])


@given(TRUTHS, LABELS, IOUS)
def test_every_object_in_range_is_hit_or_missed(truth: list[TruthRow], labels: list[LabelRow], iou: float):
    counts = count(truth, labels, iou=iou)
    in_range = sum(category != "DontCare" and distance <= 80 for _, category, distance in truth)
    sure = sum(name != "person" and score >= 0.8 for _, name, score in labels)
    assert counts.tp + counts.fn == in_range
    assert counts.tp + counts.fp <= sure


@given(TRUTHS, LABELS, IOUS, st.randoms(use_true_random=False))
def test_the_order_of_rows_does_not_matter(truth: list[TruthRow], labels: list[LabelRow], iou: float, random):
    expected = count(truth, labels, iou=iou)
    random.shuffle(truth)
    random.shuffle(labels)
    assert count(truth, labels, iou=iou) == expected


@given(TRUTHS, LABELS)
def test_weaker_labels_change_nothing_about_surer_ones(truth: list[TruthRow], labels: list[LabelRow]):
    sure = [label for label in labels if label[2] >= 0.8]
    assert count(truth, labels) == count(truth, sure)


@given(TRUTHS, LABELS)
def test_a_larger_iou_never_finds_more(truth: list[TruthRow], labels: list[LabelRow]):
    hits = [count(truth, labels, iou=iou).tp for iou in (0.1, 0.25, 0.5, 0.75)]
    assert hits == sorted(hits, reverse=True)
