"""The paper's table for a drive, and what stands behind it.

Three methods are counted on the same images: the detector's boxes as they are ("without-tracking"), tracks with the
labels that their own observations give ("single-camera"), and the labels as they are, of all cameras ("multi-camera").
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from labeler.drive.types import Truth
from labeler.evaluation.categories import NOT_COUNTED, class_of_labels
from labeler.evaluation.counting import ABSORBED, HIT, Criterion, Labels2D, Tally, judge
from labeler.evaluation.curves import average_precision, precision_recall_at
from labeler.evaluation.matching import Pairs, overlapping_pairs
from labeler.evaluation.merges import score_merges
from labeler.evaluation.reliability import ReliabilityCounts
from labeler.evaluation.track_labels import TrackLabels
from labeler.evaluation.tracking import MIN_IOU, TrackingRows, clear, hota, idf1
from labeler.evaluation.truth import TruthTable, front_cameras, image_number, prepare_truth
from labeler.evaluation.types import (
    IOUS,
    METHODS,
    TRUTHS,
    BinRow,
    BoxRows,
    Calibration,
    Curve,
    EvaluatedLabels,
    Evaluation,
    EvaluationConfig,
    EvaluationError,
    LabelRows,
    MergeCounts,
    Row,
    Tracking,
)
from labeler.tracking.types import NO_DETECTION, Observations

DISTANCES_M = (0.0, 10.0, 20.0, 40.0, 60.0, 80.0)
VISIBLE_SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)
CALIBRATION_IOU = 0.5
_THRESHOLDS = np.linspace(1.0, 0.0, 101)

WITHOUT_TRACKING, SINGLE_CAMERA, MULTI_CAMERA = METHODS


def evaluate_labels(
    source: EvaluatedLabels, truth: Truth | None, *, drive_name: str, config: EvaluationConfig | None = None
) -> Evaluation:
    """Compare the labels of a drive with its truth.

    Reads detections once and labels twice, part by part. Raises EvaluationError when the truth has no boxes in the
    images.
    """
    config = config or EvaluationConfig()
    table = None if truth is None else prepare_truth(truth, source.cameras, config)
    if truth is None or truth.boxes_2d is None or table is None:
        raise EvaluationError(
            f"The drive {drive_name} has no true boxes in its images, so there is nothing to compare its labels with. "
            "Evaluate a drive that comes with truth: annotations_2d.feather in an Argoverse 2 log, label_02 in KITTI."
        )
    counted = _Counted(source, table, config)
    if source.open_detections is not None:
        for part in source.open_detections():
            counted.add_detections(part)
    for part in source.open_labels():
        counted.add_labels(part, with_own=source.open_detections is None)
    merged = score_merges(truth.boxes_2d, counted.observations, counted.identity_of)
    distance_edges = (*(edge for edge in DISTANCES_M if edge < config.max_distance_m), config.max_distance_m)
    return Evaluation(
        drive=drive_name,
        confidence=config.confidence,
        max_distance_m=config.max_distance_m,
        min_visible_pixels=config.min_visible_pixels,
        classes=config.classes,
        without_tracking_from="observations" if source.open_detections is None else "detections",
        truth_count=int(np.count_nonzero(table.counted)),
        dont_care_count=int(np.count_nonzero(~table.counted)),
        rows=counted.rows(),
        by_distance=counted.by_bin(table.distance_m, distance_edges),
        by_visible_share=[] if table.visible_share is None else counted.by_bin(table.visible_share, VISIBLE_SHARES),
        curves=[counted.curve(method, iou) for method in METHODS for iou in IOUS],
        tracking=_score_tracking(counted.tracking_rows()),
        merges=MergeCounts(right=merged.found, wrong=merged.wrong_merges, missed=merged.missed),
        calibration=counted.calibration(),
    )


@dataclass(frozen=True, eq=False)
class _TrackingParts:
    """Labels that take part in tracking, part by part: image and identity; and pairs of (truth row, label row)."""

    image: list[NDArray[np.int64]] = field(default_factory=list[NDArray[np.int64]])
    identity: list[NDArray[np.int32]] = field(default_factory=list[NDArray[np.int32]])
    pairs: list[Pairs] = field(default_factory=list[Pairs])


class _Counted:
    """What is counted while the drive streams by."""

    def __init__(self, source: EvaluatedLabels, table: TruthTable, config: EvaluationConfig) -> None:
        self._source = source
        self._table = table
        self._config = config
        self._compare_classes = config.classes == "aware"
        self._kinds = TRUTHS if table.visible_px is not None else TRUTHS[:1]
        self._label_class = class_of_labels(source.class_names)
        criteria: list[Criterion] = [(kind, iou) for kind in self._kinds for iou in IOUS]
        self._tallies = {method: Tally(table, criteria, compare_classes=self._compare_classes) for method in METHODS}
        self._of_tracks = TrackLabels(source)
        self._tracking = _TrackingParts()
        self._tracked_labels = 0
        self._by_probability = ReliabilityCounts()
        self._by_confidence = ReliabilityCounts()
        self.observations: dict[str, list[Observations]] = {camera: [] for camera in source.cameras}
        self.identity_of: dict[int, int] = {}

    def add_detections(self, part: BoxRows) -> None:
        labels = self._labels(part)
        span = self._truth_of(labels)
        self._tallies[WITHOUT_TRACKING].add(labels, span, self._pairs(labels, span))

    def add_labels(self, part: LabelRows, *, with_own: bool) -> None:
        """Count a part's labels, ``with_own`` the detector's own class and score of each observation as well."""
        own = self._labels(part.own)
        span = self._truth_of(own)
        pairs = self._pairs(own, span)
        merged = self._relabelled(own, part.label_class_id, part.label_score)
        if with_own:
            self._tallies[WITHOUT_TRACKING].add(own, span, pairs)
        self._tallies[SINGLE_CAMERA].add(self._relabelled(own, *self._of_tracks.of(part)), span, pairs)
        self._tallies[MULTI_CAMERA].add(merged, span, pairs)
        self._follow(merged, part.identity_id, span, pairs["whole"])
        self._weigh(merged, part.probability, span, pairs["whole"])
        self._keep_observations(part)

    def calibration(self) -> Calibration:
        """How well probability and confidence tell which labels are right."""
        return Calibration(
            iou=CALIBRATION_IOU,
            probability=self._by_probability.reliability(),
            confidence=self._by_confidence.reliability(),
        )

    def rows(self) -> list[Row]:
        front = front_cameras(self._source.cameras)
        groups: dict[str, Sequence[int] | None] = {"all": None}
        if front:
            groups["front"] = front
        rows: list[Row] = []
        for method in METHODS:
            for name, cameras in groups.items():
                for kind in self._kinds:
                    for iou in IOUS:
                        counts = self._tallies[method].counts(
                            (kind, iou), confidence=self._config.confidence, cameras=cameras
                        )
                        row = Row(
                            method=method,
                            cameras=name,
                            truth=kind,
                            iou=iou,
                            precision=counts.precision,
                            recall=counts.recall,
                            tp=counts.tp,
                            fp=counts.fp,
                            fn=counts.fn,
                        )
                        rows.append(row)
        return rows

    def by_bin(self, value: NDArray[np.float32], edges: Sequence[float]) -> list[BinRow]:
        """Recall of objects by a value (T,) that each has; those without it (NaN) are in no bin."""
        rows: list[BinRow] = []
        for method in METHODS:
            for iou in IOUS:
                for start, stop in pairwise(edges):
                    below = value <= stop if stop == edges[-1] else value < stop
                    objects = (value >= start) & below
                    tp, fn = self._tallies[method].found(("whole", iou), objects, confidence=self._config.confidence)
                    recall = tp / (tp + fn) if tp + fn else None
                    rows.append(BinRow(method=method, iou=iou, start=start, stop=stop, recall=recall, tp=tp, fn=fn))
        return rows

    def curve(self, method: str, iou: float) -> Curve:
        tally = self._tallies[method]
        score, is_hit = tally.judged_scores(("whole", iou))
        precision, recall = precision_recall_at(score, is_hit, _THRESHOLDS, truth_count=tally.truth_count)
        return Curve(
            method=method,
            iou=iou,
            average_precision=average_precision(score, is_hit, truth_count=tally.truth_count),
            threshold=np.round(_THRESHOLDS, 2).tolist(),
            precision=np.round(precision, 6).tolist(),
            recall=np.round(recall, 6).tolist(),
        )

    def tracking_rows(self) -> TrackingRows:
        """Objects, sure labels, and the pairs of them that overlap."""
        objects = np.flatnonzero(self._table.counted)
        place = np.full(len(self._table), -1)
        place[objects] = np.arange(len(objects))
        parts = self._tracking
        identity = np.concatenate([np.zeros(0, np.int32), *parts.identity])
        return TrackingRows(
            truth_image=self._table.image[objects],
            truth_id=self._table.object_id[objects],
            label_image=np.concatenate([np.zeros(0, np.int64), *parts.image]),
            label_id=np.unique(identity, return_inverse=True)[1].astype(np.int32),
            pair_truth=place[np.concatenate([np.zeros(0, np.intp), *(pairs.b for pairs in parts.pairs)])],
            pair_label=np.concatenate([np.zeros(0, np.intp), *(pairs.a for pairs in parts.pairs)]),
            pair_iou=np.concatenate([np.zeros(0), *(pairs.iou for pairs in parts.pairs)]),
        )

    def _labels(self, boxes: BoxRows) -> Labels2D:
        image = image_number(boxes.frame_index, boxes.camera, len(self._source.cameras))
        return Labels2D(image, boxes.camera, boxes.xyxy_px, self._label_class[boxes.class_id], boxes.score)

    def _relabelled(self, labels: Labels2D, class_id: NDArray[np.int16], score: NDArray[np.float32]) -> Labels2D:
        return replace(labels, label_class=self._label_class[class_id], score=score)

    def _truth_of(self, labels: Labels2D) -> slice:
        """The rows of the truth from the first to the last image of a part."""
        if len(labels.image) == 0:
            return slice(0, 0)
        first, last = int(labels.image.min()), int(labels.image.max())
        start, stop = np.searchsorted(self._table.image, [first, last + 1], side="left").tolist()
        return slice(start, stop)

    def _pairs(self, labels: Labels2D, span: slice) -> Mapping[str, Pairs]:
        truth = self._table[span]
        return {
            kind: overlapping_pairs(labels.image, labels.xyxy_px, truth.image, truth.boxes_px(kind))
            for kind in self._kinds
        }

    def _follow(self, labels: Labels2D, identity_id: NDArray[np.int32], span: slice, pairs: Pairs) -> None:
        """Keep the labels that are sure and not absorbed, and their overlaps with objects of any class."""
        with np.errstate(invalid="ignore"):
            sure = labels.score >= self._config.confidence
        sure_labels = replace(labels, label_class=np.where(sure, labels.label_class, np.int16(NOT_COUNTED)))
        truth = self._table[span]
        judged = judge(sure_labels, truth, pairs, min_iou=MIN_IOU, compare_classes=False)
        kept = sure_labels.counted & (judged.outcome != ABSORBED)
        place = np.cumsum(kept) - 1 + self._tracked_labels
        pairs = pairs[kept[pairs.a] & truth.counted[pairs.b]]
        self._tracking.image.append(labels.image[kept])
        self._tracking.identity.append(identity_id[kept])
        self._tracking.pairs.append(replace(pairs, a=place[pairs.a], b=pairs.b + span.start))
        self._tracked_labels += int(np.count_nonzero(kept))

    def _weigh(self, labels: Labels2D, probability: NDArray[np.float32], span: slice, pairs: Pairs) -> None:
        """Set what labels said of themselves against what they are."""
        judged = judge(labels, self._table[span], pairs, min_iou=CALIBRATION_IOU, compare_classes=self._compare_classes)
        kept = labels.counted & (judged.outcome != ABSORBED)
        is_right = judged.outcome[kept] == HIT
        self._by_probability.add(probability[kept], is_right)
        self._by_confidence.add(labels.score[kept], is_right)

    def _keep_observations(self, part: LabelRows) -> None:
        own = part.own
        self.identity_of.update(zip(part.track_id.tolist(), part.identity_id.tolist(), strict=True))
        for number, camera in enumerate(self._source.cameras):
            rows = np.flatnonzero(own.camera == number)
            observations = Observations(
                part.track_id[rows],
                own.frame_index[rows],
                own.xyxy_px[rows],
                own.score[rows],
                own.class_id[rows],
                np.full(len(rows), NO_DETECTION, np.int32),
            )
            self.observations[camera].append(observations)


def _score_tracking(rows: TrackingRows) -> Tracking:
    whole, counts = hota(rows), clear(rows)
    return Tracking(
        hota=None if whole is None else whole.hota,
        deta=None if whole is None else whole.deta,
        assa=None if whole is None else whole.assa,
        idf1=idf1(rows),
        mota=counts.mota,
        id_switches=counts.id_switches,
    )
