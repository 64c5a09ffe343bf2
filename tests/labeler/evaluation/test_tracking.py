"""By hand, and equal to the reference implementations."""

import math
from typing import Any

import motrics
import numpy as np
import pytest

from labeler.evaluation.matching import overlapping_pairs
from labeler.evaluation.tracking import ClearScore, TrackingRows, clear, hota, idf1
from labeler.geometry.boxes_2d import iou_matrix

Seen = list[tuple[int, int, float]]
"""Image, id, and x of a box of 10 by 10 px."""


def boxes(seen: Seen) -> np.ndarray:
    return np.array([[x, 0, x + 10, 10] for _, _, x in seen], np.float32).reshape(-1, 4)


def rows(truth: Seen, labels: Seen) -> TrackingRows:
    truth_image = np.array([image for image, _, _ in truth], np.int64)
    label_image = np.array([image for image, _, _ in labels], np.int64)
    pairs = overlapping_pairs(label_image, boxes(labels), truth_image, boxes(truth))
    return TrackingRows(
        truth_image=truth_image,
        truth_id=np.array([number for _, number, _ in truth], np.int32),
        label_image=label_image,
        label_id=np.array([number for _, number, _ in labels], np.int32),
        pair_truth=pairs.b,
        pair_label=pairs.a,
        pair_iou=pairs.iou,
    )


CAR = [(image, 0, 0.0) for image in range(4)]


@pytest.mark.parametrize(
    ("labels", "expected_hota", "expected_idf1", "expected_clear"),
    [
        # all found, one identity
        ([(image, 5, 0.0) for image in range(4)], 1.0, 1.0, ClearScore(4, 0, 0, 0)),
        # the identity changes half way: DetA 1, each match weighs 2 / 4; the better half makes IDF1 2 * 2 / 8
        ([(0, 5, 0.0), (1, 5, 0.0), (2, 9, 0.0), (3, 9, 0.0)], 0.5**0.5, 0.5, ClearScore(4, 0, 0, 1)),
        # half is found: DetA 2 / 4, each match weighs 2 / 4; IDF1 2 * 2 / (4 + 2)
        ([(0, 5, 0.0), (1, 5, 0.0)], 0.5, 2 / 3, ClearScore(2, 0, 2, 0)),
        # a gap is no switch
        ([(0, 5, 0.0), (3, 5, 0.0)], 0.5, 2 / 3, ClearScore(2, 0, 2, 0)),
        # nothing is found, and two labels lie on nothing
        ([(0, 5, 50.0), (1, 5, 50.0)], 0.0, 0.0, ClearScore(0, 2, 4, 0)),
        ([], 0.0, 0.0, ClearScore(0, 0, 4, 0)),
    ],
)
def test_one_car(labels: Seen, expected_hota: float, expected_idf1: float, expected_clear: ClearScore):
    found = rows(CAR, labels)
    score = hota(found)
    assert score is not None
    assert score.hota == pytest.approx(expected_hota)
    assert idf1(found) == pytest.approx(expected_idf1)
    assert clear(found) == expected_clear


def test_a_match_is_kept_though_another_label_overlaps_more():
    truth = [(0, 0, 0.0), (1, 0, 0.0)]
    labels = [(0, 5, 0.0), (1, 5, 3.0), (1, 9, 1.0)]  # in the second image 9 is nearer, but 5 still overlaps by .54
    assert clear(rows(truth, labels)) == ClearScore(tp=2, fp=1, fn=0, id_switches=0)


def test_mota():
    assert clear(rows(CAR, [(0, 5, 0.0), (1, 9, 0.0), (2, 9, 50.0)])).mota == pytest.approx((2 - 1 - 1) / 4)
    assert clear(rows([], [(0, 5, 0.0)])).mota is None


def test_without_truth_and_labels_there_is_no_score():
    assert hota(rows([], [])) is None
    assert idf1(rows([], [])) is None


def busy_street() -> tuple[Seen, Seen]:
    """200 images of eight objects that come and go; labels swap identities, miss, shift, and lie on nothing."""
    truth: Seen = []
    labels: Seen = []
    for image in range(200):
        for one in range(8):
            if (image + 5 * one) % 23 < 14 and image % 17:
                x = one * 7 + 0.5 * math.sin(image + one)
                truth.append((image, one, x))
                if (3 * image + one) % 7 and image % 13:
                    name = (one + image // 25 * 3) % 8
                    labels.append((image, name, x + 2.5 * math.sin(3.7 * image + 1.3 * one)))
        if image % 4 == 0:
            labels.append((image, 8, (image * 11) % 60))
    return truth, labels


def by_image(found: TrackingRows, truth: Seen, labels: Seen) -> tuple[list[list[int]], list[list[int]], list[Any]]:
    """Ids of the objects and of the labels of each image, and their IoUs, as the references want them."""
    truth_ids, label_ids, iou = [], [], []
    for image in range(200):
        of_truth, of_labels = np.flatnonzero(found.truth_image == image), np.flatnonzero(found.label_image == image)
        truth_ids.append(found.truth_id[of_truth].tolist())
        label_ids.append(found.label_id[of_labels].tolist())
        iou.append(iou_matrix(boxes(truth)[of_truth], boxes(labels)[of_labels]).tolist())
    return truth_ids, label_ids, iou


def test_equal_to_motrics():
    truth, labels = busy_street()
    found = rows(truth, labels)
    images = by_image(found, truth, labels)
    expected, score = motrics.compute_hota_from_similarity(*images), hota(found)
    assert score is not None
    assert (score.hota, score.deta, score.assa) == pytest.approx(
        (expected.hota, expected.deta, expected.assa), abs=1e-6
    )
    assert idf1(found) == pytest.approx(motrics.compute_identity_from_similarity(*images).idf1, abs=1e-9)


def test_equal_to_trackeval():
    """TrackEval itself can't be installed beside this project (it brings another OpenCV); these are the
    numbers of its release 1.3.0."""
    found = rows(*busy_street())
    score = hota(found)
    assert score is not None
    assert (score.hota, score.deta, score.assa) == pytest.approx(
        (0.1549736352912235, 0.5452247976807294, 0.04434701004895312), abs=1e-6
    )
    assert idf1(found) == pytest.approx(0.12071005917159763, abs=1e-9)
    assert clear(found) == ClearScore(tp=729, fp=47, fn=185, id_switches=66)
    assert clear(found).mota == pytest.approx(0.6739606126914661, abs=1e-9)
