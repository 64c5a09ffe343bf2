"""How much better labels become by tracking: the detector's boxes, the paper's method and ours, on equal detections.

Each method gives boxes with a confidence and an identity; they are counted as ``hindsight evaluate`` counts labels (see
docs/evaluation.md). HOTA, MOTA and IDF1 are those of the labels with at least the confidence, all sequences together.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from labeler.evaluation.categories import class_of_labels
from labeler.evaluation.counting import ABSORBED, HIT, Judgement, Labels2D, judge
from labeler.evaluation.matching import UNMATCHED, Pairs, overlapping_pairs
from labeler.evaluation.sequences import DetectedSequence
from labeler.evaluation.tracking import MIN_IOU, TrackingRows, clear, hota, idf1
from labeler.evaluation.truth import TruthTable
from labeler.evaluation.types import IOUS, EvaluationConfig
from labeler.propagation import PropagationConfig, collect_votes, label_observations
from labeler.tracking import Observations, TrackingConfig, open_tracker

FAR_M = 40.0

_BASELINE = (TrackingConfig(method="baseline"), PropagationConfig(min_trust=0.0))
_TWO_STAGE = TrackingConfig(method="two_stage")
_FORWARD = TrackingConfig(method="offline", max_gap_s=0.0, refine=False, max_stitch_s=0.0)
_KEEP_ALL = PropagationConfig(min_trust=0.0)

METHODS: Mapping[str, tuple[TrackingConfig, PropagationConfig] | None] = {
    "none": None,
    "baseline": _BASELINE,
    "ours": (TrackingConfig(method="offline"), PropagationConfig()),
}
"""How each method tracks and propagates; None takes the detections as they are."""

PASSES: Mapping[str, tuple[TrackingConfig, PropagationConfig] | None] = {
    "two-stage": (_TWO_STAGE, _KEEP_ALL),
    "+ weak tracks": (_FORWARD, _KEEP_ALL),
    "+ stitching": (replace(_FORWARD, max_stitch_s=TrackingConfig().max_stitch_s), _KEEP_ALL),
    "+ refined boxes": (TrackingConfig(method="offline", max_gap_s=0.0), _KEEP_ALL),
    "+ filled gaps": (TrackingConfig(method="offline"), _KEEP_ALL),
    "+ doubtful withheld": (TrackingConfig(method="offline"), PropagationConfig()),
    "and followed back": (TrackingConfig(method="offline", follow_back=True), PropagationConfig()),
    "gaps of 0.4 s only": (TrackingConfig(method="offline", max_gap_s=0.4), PropagationConfig()),
}
"""What each pass adds, one after the other, and two variants of the whole."""

EGO_MOTIONS: Mapping[str, tuple[TrackingConfig, PropagationConfig] | None] = {
    "without ego motion": (TrackingConfig(ego_motion="none"), PropagationConfig()),
    "the car's turns alone": (TrackingConfig(ego_motion="rotation"), PropagationConfig()),
}
"""Ours with less of the car's own motion."""


class LabelRow(TypedDict):
    """Precision and recall at IoU .25 and .5, recall of what is beyond 40 m, tracking scores, and how many identities
    the objects that are found have each in the mean; None where there is nothing to divide by, or no identity."""

    method: str
    p25: float | None
    r25: float | None
    r25_far: float | None
    p50: float | None
    r50: float | None
    hota: float | None
    mota: float | None
    idf1: float | None
    identities_per_object: float | None


def benchmark_labels(
    sequences: Iterable[DetectedSequence],
    *,
    passes: bool = False,
    ego_motions: bool = False,
    config: EvaluationConfig | None = None,
) -> list[LabelRow]:
    """A row for each method over all sequences; with ``passes``, one for each pass of ours as well, with
    ``ego_motions`` one for each of EGO_MOTIONS."""
    config = config or EvaluationConfig()
    methods = {**METHODS, **(EGO_MOTIONS if ego_motions else {}), **(PASSES if passes else {})}
    counted = {method: _Counted() for method in methods}
    for sequence in sequences:
        for method, how in methods.items():
            labels = _detected(sequence) if how is None else label_sequence(sequence, *how)
            counted[method].add(labels, sequence.truth, config.confidence)
    return [counted[method].row(method, with_identities=how is not None) for method, how in methods.items()]


@dataclass(frozen=True, eq=False)
class BoxLabels:
    """Labels of one sequence: ``frame`` (N,), ``xyxy_px`` (N, 4), ``label_class`` (N,) as in
    :mod:`labeler.evaluation.categories`, ``confidence`` (N,), NaN where there is none, and ``identity`` (N,)."""

    frame: NDArray[np.int64]
    xyxy_px: NDArray[np.float32]
    label_class: NDArray[np.int16]
    confidence: NDArray[np.float32]
    identity: NDArray[np.int32]


def label_sequence(sequence: DetectedSequence, tracking: TrackingConfig, propagation: PropagationConfig) -> BoxLabels:
    """Track one camera's frames, and give each observation its track's label."""
    tracker = open_tracker(tracking, class_groups=sequence.class_groups, motion=sequence.motion_of(tracking))
    observed = [found for found in tracker.track(sequence.frames, first_track_id=1) if len(found)]
    votes = collect_votes((("camera", found) for found in observed), {}, config=propagation)
    labels = [label_observations(found, {}, votes, config=propagation) for found in observed]
    observed.append(Observations.empty())
    return BoxLabels(
        frame=np.concatenate([found.frame_index for found in observed]).astype(np.int64),
        xyxy_px=np.concatenate([found.xyxy_px for found in observed]),
        label_class=class_of_labels(sequence.class_names)[
            np.concatenate([np.zeros(0, np.int16), *(label.class_id for label in labels)])
        ],
        confidence=np.concatenate([np.zeros(0, np.float32), *(label.score for label in labels)]),
        identity=np.concatenate([found.track_id for found in observed]),
    )


def _detected(sequence: DetectedSequence) -> BoxLabels:
    found = [frame.detections for frame in sequence.frames]
    count = sum(len(detections) for detections in found)
    return BoxLabels(
        frame=np.repeat([frame.frame_index for frame in sequence.frames], [len(one) for one in found]).astype(np.int64),
        xyxy_px=np.concatenate([np.zeros((0, 4), np.float32), *(one.xyxy_px for one in found)]),
        label_class=class_of_labels(sequence.class_names)[
            np.concatenate([np.zeros(0, np.int16), *(one.class_id for one in found)])
        ],
        confidence=np.concatenate([np.zeros(0, np.float32), *(one.score for one in found)]),
        identity=np.arange(count, dtype=np.int32),
    )


@dataclass(eq=False)
class _Counted:
    """Counts of one method, sequence by sequence."""

    hits: dict[float, int] = field(default_factory=lambda: dict.fromkeys(IOUS, 0))
    labels: dict[float, int] = field(default_factory=lambda: dict.fromkeys(IOUS, 0))
    cars: int = 0
    far_hits: int = 0
    far_cars: int = 0
    found_objects: int = 0
    their_identities: int = 0
    parts: list[TrackingRows] = field(default_factory=list[TrackingRows])

    def add(self, labels: BoxLabels, truth: TruthTable, confidence: float) -> None:
        with np.errstate(invalid="ignore"):
            sure = np.flatnonzero((labels.confidence >= confidence) & (labels.label_class >= 0))
        boxes = Labels2D(
            labels.frame[sure],
            np.zeros(len(sure), np.int16),
            labels.xyxy_px[sure],
            labels.label_class[sure],
            labels.confidence[sure],
        )
        pairs = overlapping_pairs(boxes.image, boxes.xyxy_px, truth.image, truth.whole_px)
        far = truth.counted & (truth.distance_m > FAR_M)
        self.cars += int(np.count_nonzero(truth.counted))
        self.far_cars += int(np.count_nonzero(far))
        for iou in IOUS:
            judged = judge(boxes, truth, pairs, min_iou=iou, compare_classes=True)
            self.hits[iou] += int(np.count_nonzero(judged.outcome == HIT))
            self.labels[iou] += int(np.count_nonzero(judged.outcome != ABSORBED))
            if iou == IOUS[0]:
                self.far_hits += int(np.count_nonzero(far[judged.truth_row[judged.truth_row != UNMATCHED]]))
        judged = judge(boxes, truth, pairs, min_iou=MIN_IOU, compare_classes=False)
        hits = judged.truth_row != UNMATCHED
        who = np.stack([truth.object_id[judged.truth_row[hits]], labels.identity[sure][hits]])
        self.found_objects += len(np.unique(who[0]))
        self.their_identities += np.unique(who, axis=1).shape[1]
        self.parts.append(_tracking_rows(boxes, labels.identity[sure], truth, pairs, judged))

    def row(self, method: str, *, with_identities: bool) -> LabelRow:
        near, exact = IOUS
        rows = _joined(self.parts)
        score = hota(rows) if with_identities else None
        return LabelRow(
            method=method,
            p25=_share(self.hits[near], self.labels[near]),
            r25=_share(self.hits[near], self.cars),
            r25_far=_share(self.far_hits, self.far_cars),
            p50=_share(self.hits[exact], self.labels[exact]),
            r50=_share(self.hits[exact], self.cars),
            hota=None if score is None else round(score.hota, 5),
            mota=_rounded(clear(rows).mota) if with_identities else None,
            idf1=_rounded(idf1(rows)) if with_identities else None,
            identities_per_object=_share(self.their_identities, self.found_objects) if with_identities else None,
        )


def _tracking_rows(
    labels: Labels2D, identity: NDArray[np.int32], truth: TruthTable, pairs: Pairs, judged: Judgement
) -> TrackingRows:
    """Cars that count, labels that are not absorbed, and their overlaps; images and identities of this sequence."""
    kept = judged.outcome != ABSORBED
    pairs = pairs[kept[pairs.a] & truth.counted[pairs.b]]
    return TrackingRows(
        truth_image=truth.image[truth.counted],
        truth_id=truth.object_id[truth.counted],
        label_image=labels.image[kept],
        label_id=np.unique(identity[kept], return_inverse=True)[1].astype(np.int32),
        pair_truth=(np.cumsum(truth.counted) - 1)[pairs.b],
        pair_label=(np.cumsum(kept) - 1)[pairs.a],
        pair_iou=pairs.iou,
    )


def _joined(parts: Iterable[TrackingRows]) -> TrackingRows:
    """All sequences as one: their images follow one another, and no identity or object is in two."""
    shifted: list[TrackingRows] = []
    images = objects = identities = truths = labels = 0
    for part in parts:
        shifted.append(
            TrackingRows(
                part.truth_image + images,
                (part.truth_id + objects).astype(np.int32),
                part.label_image + images,
                (part.label_id + identities).astype(np.int32),
                part.pair_truth + truths,
                part.pair_label + labels,
                part.pair_iou,
            )
        )
        images += 1 + int(max(part.truth_image.max(initial=0), part.label_image.max(initial=0)))
        objects += 1 + int(part.truth_id.max(initial=0))
        identities += 1 + int(part.label_id.max(initial=0))
        truths, labels = truths + len(part.truth_id), labels + len(part.label_id)
    return TrackingRows(
        *(np.concatenate([getattr(part, one) for part in shifted]) for one in TrackingRows.__dataclass_fields__)
    )


def _share(part: int, whole: int) -> float | None:
    return round(part / whole, 5) if whole else None


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, 5)
