import contextlib
import io
from typing import Any

import numpy as np
import pytest
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval

from labeler.evaluation.categories import CLASSES
from labeler.evaluation.counting import Labels2D, Tally
from labeler.evaluation.curves import average_precision, precision_recall_at
from labeler.evaluation.matching import overlapping_pairs
from labeler.evaluation.truth import TruthTable

# From the surest: hit, false, hit; one of three objects is never found.
SCORE = np.array([0.5, 0.9, 0.7], np.float32)
IS_HIT = np.array([True, True, False])

IMAGES = 60


@pytest.mark.parametrize(
    ("threshold", "precision", "recall"),
    [
        (0.95, 1.0, 0.0),  # no label left: nothing said, nothing wrong
        (0.9, 1.0, 1 / 3),  # a label of just the threshold is in
        (0.6, 1 / 2, 1 / 3),
        (0.0, 2 / 3, 2 / 3),
    ],
)
def test_precision_and_recall_at_a_threshold(threshold: float, precision: float, recall: float):
    found = precision_recall_at(SCORE, IS_HIT, np.array([threshold]), truth_count=3)
    assert [values.tolist() for values in found] == [[pytest.approx(precision)], [pytest.approx(recall)]]


def test_average_precision_by_hand():
    # precision 1 up to recall 1/3 (34 of the 101 recalls: 0 to .33), 2/3 up to 2/3 (33: .34 to .66), then 0
    assert average_precision(SCORE, IS_HIT, truth_count=3) == pytest.approx((34 + 33 * 2 / 3) / 101)


def test_without_truth_there_is_no_average_precision():
    assert average_precision(SCORE, IS_HIT, truth_count=0) is None
    assert precision_recall_at(SCORE, IS_HIT, np.array([0.0]), truth_count=0)[1].tolist() == [0.0]


def test_without_labels_it_is_nothing():
    nothing = np.zeros(0, np.float32)
    assert average_precision(nothing, nothing.astype(np.bool_), truth_count=2) == 0.0


def crowded_images() -> tuple[TruthTable, Labels2D]:
    """Cars and trucks in a row, some not to care about, with labels that shift, miss, double and mix up classes."""
    random = np.random.default_rng(3)
    truth, labels = [], []
    for image in range(IMAGES):
        for place in range(random.integers(1, 9)):
            x, kind = place * 14.0 + random.uniform(0, 6), int(random.random() < 0.3)
            truth.append((image, kind, random.random() > 0.15, (x, 0.0, x + 20, 12.0)))
            for _ in range(random.integers(0, 3)):
                shift = random.normal(0, 3, 4)
                box = (x + shift[0], shift[1], x + 20 + shift[2], 12 + shift[3])
                labels.append((image, kind if random.random() < 0.9 else 1 - kind, random.random(), box))
    image, kind, counted, boxes = zip(*truth, strict=True)
    table = TruthTable(
        image=np.array(image),
        camera=np.zeros(len(truth), np.int16),
        object_id=np.arange(len(truth), dtype=np.int32),
        category_class=np.array(kind, np.int16),
        counted=np.array(counted),
        whole_px=np.array(boxes, np.float32),
        visible_px=None,
        distance_m=np.zeros(len(truth), np.float32),
        visible_share=None,
    )
    image, kind, score, boxes = zip(*labels, strict=True)
    rows = Labels2D(
        image=np.array(image),
        camera=np.zeros(len(labels), np.int16),
        xyxy_px=np.array(boxes, np.float32),
        label_class=np.array(kind, np.int16),
        score=np.array(score, np.float32),
    )
    return table, rows


def of_class(table: TruthTable, labels: Labels2D, kind: int) -> tuple[TruthTable, Labels2D]:
    """The truth and the labels of one class; what is not to care about stays only in its own, as COCO has it."""
    mine = labels.label_class == kind
    return table[np.flatnonzero(table.category_class == kind)], Labels2D(
        labels.image[mine], labels.camera[mine], labels.xyxy_px[mine], labels.label_class[mine], labels.score[mine]
    )


def coco_average_precision(table: TruthTable, labels: Labels2D, *, kind: int, iou: float) -> float:
    """What pycocotools says. A region not to care about is a crowd: COCO's word for one that absorbs labels."""
    whole, boxes = table.whole_px.astype(np.float64), labels.xyxy_px.astype(np.float64)
    reference: Any = COCO()
    reference.dataset = {
        "info": {},
        "images": [{"id": image} for image in range(IMAGES)],
        "categories": [{"id": kind, "name": CLASSES[kind]}],
        "annotations": [
            {
                "id": row + 1,
                "image_id": int(table.image[row]),
                "category_id": kind,
                "bbox": [*box[:2], *(box[2:] - box[:2])],
                "area": float(np.prod(box[2:] - box[:2])),
                "iscrowd": int(not table.counted[row]),
            }
            for row, box in enumerate(whole)
        ],
    }
    with contextlib.redirect_stdout(io.StringIO()):
        reference.createIndex()
        found = reference.loadRes(
            [
                {
                    "image_id": int(labels.image[row]),
                    "category_id": kind,
                    "bbox": [*box[:2], *(box[2:] - box[:2])],
                    "score": float(labels.score[row]),
                }
                for row, box in enumerate(boxes)
            ]
        )
        evaluation: Any = COCOeval(reference, found, "bbox")
        evaluation.params.iouThrs = np.array([iou])
        evaluation.evaluate()
        evaluation.accumulate()
    return float(evaluation.eval["precision"][0, :, 0, 0, -1].mean())


@pytest.mark.parametrize(("kind", "iou"), [(0, 0.5), (1, 0.5)])
def test_equal_to_pycocotools(kind: int, iou: float):
    table, labels = of_class(*crowded_images(), kind)
    assert not table.counted.all()
    pairs = overlapping_pairs(labels.image, labels.xyxy_px, table.image, table.whole_px)
    tally = Tally(table, [("whole", iou)], compare_classes=True)
    tally.add(labels, slice(0, len(table)), {"whole": pairs})
    score, is_hit = tally.judged_scores(("whole", iou))
    found = average_precision(score, is_hit, truth_count=tally.truth_count)
    assert found == pytest.approx(coco_average_precision(table, labels, kind=kind, iou=iou), abs=1e-9)
    assert found is not None
    assert 0.1 < found < 0.9  # the fixture is neither easy nor hopeless


@pytest.mark.parametrize("iou", [0.25, 0.75])
def test_equal_to_pycocotools_where_all_truth_counts(iou: float):
    """At an IoU other than .5 COCO's crowds absorb by another rule than ours, so here there are none."""
    table, labels = of_class(*crowded_images(), 0)
    table.counted[:] = True
    pairs = overlapping_pairs(labels.image, labels.xyxy_px, table.image, table.whole_px)
    tally = Tally(table, [("whole", iou)], compare_classes=True)
    tally.add(labels, slice(0, len(table)), {"whole": pairs})
    score, is_hit = tally.judged_scores(("whole", iou))
    found = average_precision(score, is_hit, truth_count=tally.truth_count)
    assert found == pytest.approx(coco_average_precision(table, labels, kind=0, iou=iou), abs=1e-9)
