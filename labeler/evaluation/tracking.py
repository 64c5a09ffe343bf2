"""HOTA, IDF1, MOTA and identity switches of labels that carry identities, over all images of a drive.

The images are one sequence: by time, and at one time camera by camera. Identities and true objects have one number in
all cameras, so a car that is called 5 in front and 9 on the left counts as mixed up, and one that keeps its number does
not. Sources: HOTA, Luiten et al., IJCV 2021; IDF1, Ristani et al., 2016; MOTA (CLEAR), Bernardin and Stiefelhagen,
2008. The numbers are those of TrackEval on the same sequence.

All works on the pairs of label and object that overlap, so that memory grows with these and not with the product of the
numbers of identities and objects.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

ALPHAS = np.arange(0.05, 0.99, 0.05)
MIN_IOU = 0.5
_EPSILON = float(np.finfo("float").eps)


@dataclass(frozen=True, eq=False)
class TrackingRows:
    """Objects and labels of all images, and the pairs of them that overlap.

    ``truth_image`` (T,) int64 and ``label_image`` (L,) int64 number the images in order; ``truth_id`` (T,) and
    ``label_id`` (L,) int32 say which object or identity, none twice in an image. ``pair_truth`` and ``pair_label`` (P,)
    intp are rows of the two, ``pair_iou`` (P,) float64 is above 0.
    """

    truth_image: NDArray[np.int64]
    truth_id: NDArray[np.int32]
    label_image: NDArray[np.int64]
    label_id: NDArray[np.int32]
    pair_truth: NDArray[np.intp]
    pair_label: NDArray[np.intp]
    pair_iou: NDArray[np.float64]


@dataclass(frozen=True)
class HotaScore:
    """HOTA, and detection and association accuracy in it: each the mean over the IoUs .05, .10, ... .95."""

    hota: float
    deta: float
    assa: float


@dataclass(frozen=True)
class ClearScore:
    """Matches at an IoU of .5 that hold on to earlier ones: true and false positives, misses, identity switches."""

    tp: int
    fp: int
    fn: int
    id_switches: int

    @property
    def mota(self) -> float | None:
        """1 less false positives, misses and switches per object; None without truth."""
        truth_count = self.tp + self.fn
        return (self.tp - self.fp - self.id_switches) / truth_count if truth_count else None


def hota(rows: TrackingRows) -> HotaScore | None:
    """HOTA of a sequence; None where there is neither truth nor label."""
    truth_count, label_count = len(rows.truth_id), len(rows.label_id)
    if truth_count + label_count == 0:
        return None
    if truth_count == 0 or label_count == 0:
        return HotaScore(0.0, 0.0, 0.0)
    keys, key_of_pair = np.unique(_identity_pairs(rows), return_inverse=True)
    alignment = _alignment(rows, keys, key_of_pair)[key_of_pair]
    chosen = _assign_by_image(rows, alignment * rows.pair_iou)
    iou, key = rows.pair_iou[chosen], key_of_pair[chosen]
    together = _together(rows, keys)
    scores = np.array([_hota_at(alpha, iou, key, together, truth_count + label_count) for alpha in ALPHAS])
    whole, detection, association = scores.mean(axis=0).tolist()
    return HotaScore(whole, detection, association)


def idf1(rows: TrackingRows) -> float | None:
    """IDF1 of a sequence, at an IoU of .5: the F1 score of boxes whose identity is the one that fits their object best.

    None where there is neither truth nor label."""
    total = len(rows.truth_id) + len(rows.label_id)
    if total == 0:
        return None
    close = rows.pair_iou >= MIN_IOU
    keys, counts = np.unique(_identity_pairs(rows)[close], return_counts=True)
    truth, label = np.divmod(keys, _label_ids(rows))
    return 2 * _heaviest_matching(truth, label, counts) / total


def clear(rows: TrackingRows) -> ClearScore:
    """CLEAR MOT counts of a sequence: a match of the image before is kept where it still overlaps by .5."""
    owner_ever: dict[int, int] = {}
    owner_before: dict[int, int] = {}
    tp = switches = 0
    for truth, label, iou in _images_with_both(rows):
        score = np.where(iou >= MIN_IOU - _EPSILON, iou, 0.0)
        kept = np.array([[owner_before.get(one) == other for other in label] for one in truth], np.bool_)
        kept = kept.reshape(iou.shape)
        score[kept & (score > 0)] += 1000.0
        owner_before = {}
        for row, column in zip(*linear_sum_assignment(-score), strict=True):
            if score[row, column] > _EPSILON:
                tp += 1
                switches += owner_ever.get(truth[row], label[column]) != label[column]
                owner_ever[truth[row]] = owner_before[truth[row]] = label[column]
    return ClearScore(tp=tp, fp=len(rows.label_id) - tp, fn=len(rows.truth_id) - tp, id_switches=switches)


def _label_ids(rows: TrackingRows) -> int:
    return int(rows.label_id.max(initial=0)) + 1


def _identity_pairs(rows: TrackingRows) -> NDArray[np.int64]:
    """(P,) one number for each combination of object and identity."""
    return rows.truth_id[rows.pair_truth].astype(np.int64) * _label_ids(rows) + rows.label_id[rows.pair_label]


def _together(rows: TrackingRows, keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """(K,) boxes of the object and boxes of the identity of each combination, added up."""
    truth, label = np.divmod(keys, _label_ids(rows))
    return np.bincount(rows.truth_id)[truth] + np.bincount(rows.label_id)[label]


def _alignment(rows: TrackingRows, keys: NDArray[np.int64], key_of_pair: NDArray[np.intp]) -> NDArray[np.float64]:
    """(K,) how well object and identity go together over the whole sequence, in 0..1 (HOTA's global alignment)."""
    of_truth = np.bincount(rows.pair_truth, rows.pair_iou, minlength=len(rows.truth_id))
    of_label = np.bincount(rows.pair_label, rows.pair_iou, minlength=len(rows.label_id))
    share = rows.pair_iou / (of_truth[rows.pair_truth] + of_label[rows.pair_label] - rows.pair_iou)
    potential = np.bincount(key_of_pair, share, minlength=len(keys))
    return potential / (_together(rows, keys) - potential)


def _hota_at(
    alpha: float, iou: NDArray[np.float64], key: NDArray[np.intp], together: NDArray[np.int64], boxes: int
) -> tuple[float, float, float]:
    """(HOTA, DetA, AssA) at one IoU. Each match of an object and an identity weighs as they overlap over time."""
    hits = np.bincount(key[iou >= alpha - _EPSILON], minlength=len(together))
    tp = int(hits.sum())
    detection = tp / (boxes - tp)
    association = float((hits * hits / (together - hits)).sum()) / max(1, tp)
    return float(np.sqrt(detection * association)), detection, association


def _assign_by_image(rows: TrackingRows, score: NDArray[np.float64]) -> NDArray[np.intp]:
    """Pairs, one to one in each image, with the largest sum of ``score`` (P,)."""
    chosen: list[int] = []
    for pairs, truth, label in _pairs_by_image(rows):
        matrix = np.zeros((int(truth.max()) + 1, int(label.max()) + 1))
        pair_at = np.full(matrix.shape, -1)
        matrix[truth, label] = score[pairs]
        pair_at[truth, label] = pairs
        picked = pair_at[linear_sum_assignment(-matrix)]
        chosen.extend(picked[picked >= 0].tolist())
    return np.array(chosen, np.intp)


def _images_with_both(rows: TrackingRows) -> Iterator[tuple[list[int], list[int], NDArray[np.float64]]]:
    """For each image with objects and labels, in order: ids of those that overlap any, and their IoUs (R, C)."""
    truth_images, label_images = np.unique(rows.truth_image), np.unique(rows.label_image)
    pairs_of = {
        int(rows.truth_image[rows.pair_truth[pairs[0]]]): (pairs, truth, label)
        for pairs, truth, label in _pairs_by_image(rows)
    }
    for image in np.intersect1d(truth_images, label_images).tolist():
        if image not in pairs_of:
            yield [], [], np.zeros((0, 0))
            continue
        pairs, truth, label = pairs_of[image]
        iou = np.zeros((int(truth.max()) + 1, int(label.max()) + 1))
        iou[truth, label] = rows.pair_iou[pairs]
        truth_ids, label_ids = np.zeros(iou.shape[0], np.int32), np.zeros(iou.shape[1], np.int32)
        truth_ids[truth] = rows.truth_id[rows.pair_truth[pairs]]
        label_ids[label] = rows.label_id[rows.pair_label[pairs]]
        yield truth_ids.tolist(), label_ids.tolist(), iou


def _pairs_by_image(
    rows: TrackingRows,
) -> Iterator[tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]]:
    """For each image in order: its pairs, and the place in it of each pair's object and label, counted from 0."""
    if len(rows.pair_iou) == 0:
        return
    image = rows.truth_image[rows.pair_truth]
    order = np.lexsort((rows.pair_label, rows.pair_truth, image))
    for pairs in np.split(order, np.flatnonzero(np.diff(image[order])) + 1):
        truth = np.unique(rows.pair_truth[pairs], return_inverse=True)[1]
        label = np.unique(rows.pair_label[pairs], return_inverse=True)[1]
        yield pairs, truth, label


def _heaviest_matching(a: NDArray[np.int64], b: NDArray[np.int64], weight: NDArray[np.intp]) -> int:
    """The largest sum of weights of edges (E,) between ``a`` and ``b`` of which no two share an end."""
    if len(weight) == 0:
        return 0
    a = np.unique(a, return_inverse=True)[1]
    b = np.unique(b, return_inverse=True)[1]
    nodes = int(a.max()) + int(b.max()) + 2
    graph = coo_array((weight, (a, int(a.max()) + 1 + b)), shape=(nodes, nodes))
    part_of_edge = connected_components(graph, directed=False)[1][a]
    order = np.argsort(part_of_edge, kind="stable")
    total = 0
    for edges in np.split(order, np.flatnonzero(np.diff(part_of_edge[order])) + 1):
        rows = np.unique(a[edges], return_inverse=True)[1]
        columns = np.unique(b[edges], return_inverse=True)[1]
        matrix = np.zeros((int(rows.max()) + 1, int(columns.max()) + 1), np.int64)
        matrix[rows, columns] = weight[edges]
        total += int(matrix[linear_sum_assignment(-matrix)].sum())
    return total
