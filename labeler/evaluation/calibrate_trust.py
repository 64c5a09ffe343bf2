"""Fits how far boxes of tracks can be trusted (:mod:`labeler.tracking.trust`), and says what a threshold of it does.

Tracks come from text sequences with detections and truth (:mod:`labeler.evaluation.text_sequences`), and from what
detectors find in drives with truth. Each counts alike, however long it is and by however many detectors it was seen,
but a simulated drive half as much as a recorded one. Only tracks that are sure enough to be exported count. A box is
right where it hits a true object at an IoU of .5, half right at .25, whatever its class: the class is not the box's
doing.

    python -m labeler.evaluation.calibrate_trust --model FILE ... --workspace FOLDER --fit DRIVE ... --check DRIVE ...
        --text ROOT --text-fit 0000 ... --text-check 0001 ... --out trust.json
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from labeler.detection.classes import suppression_group_of
from labeler.drive import is_simulated, open_drive
from labeler.evaluation.calibration_command import parse_options
from labeler.evaluation.categories import class_of_labels
from labeler.evaluation.counting import ABSORBED, FALSE_LABEL, HIT, Labels2D, judge
from labeler.evaluation.curve_fitting import FALLS, RISES, fit_curves
from labeler.evaluation.matching import overlapping_pairs
from labeler.evaluation.text_sequences import CAMERA, read_sequences
from labeler.evaluation.truth import TruthTable, image_number, true_boxes_of
from labeler.evaluation.types import EvaluationConfig
from labeler.pipeline import LabelSettings, label_drive
from labeler.pipeline.plan import motion_of
from labeler.pipeline.results import find_detections
from labeler.tracking import CameraMotion, DetectedFrame, Observations, TrackingConfig
from labeler.tracking.curves import CurveModel
from labeler.tracking.offline import OfflineTracker
from labeler.tracking.trust import FEATURES, shipped, trust_of

IOUS = (0.25, 0.5)
_WEIGHT_OF_SIMULATED = 0.5
_FLAGS = ("filled",)
_DIRECTIONS = {
    "relative_score": RISES,
    "on_path": RISES,
    "since_sure": FALLS,
    "length": RISES,
    "covered": FALLS,
    "narrower": FALLS,
    "flatter": FALLS,
    "near_scores": RISES,
    "from_end": RISES,
}
"""Where a feature may only speak more, or only less, for a box as it grows."""
_THRESHOLDS = (0.0, 0.1, 0.2, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6)


@dataclass(frozen=True, eq=False)
class Sample:
    """Boxes of sure tracks of one source: ``features`` (N, F), and by IoU the outcome (N,) of each against the truth.

    ``is_donor`` (N,) is whether a box is so sure itself that no threshold takes its label; ``objects`` is how many true
    objects there are, ``weight`` how much the sample counts."""

    name: str
    features: NDArray[np.float64]
    outcome: Mapping[float, NDArray[np.uint8]]
    is_donor: NDArray[np.bool_]
    objects: int
    weight: float


def samples_of_drive(folder: Path, *, models: Sequence[Path], workspace: Path) -> Iterator[Sample]:
    """The boxes that each model finds in each camera; EvaluationError where the drive has no true boxes."""
    drive = open_drive(folder)
    cameras = tuple(camera.name for camera in drive.cameras)
    table = true_boxes_of(drive, EvaluationConfig())
    weight = _WEIGHT_OF_SIMULATED if is_simulated(drive.root) else 1.0
    for model in models:
        labelled = label_drive(drive, model=model, workspace=workspace, settings=LabelSettings())
        groups: list[int] = suppression_group_of(labelled.class_names).tolist()
        found = find_detections(workspace, labelled.key) or {}
        for camera, open_frames in found.items():
            yield _sample(
                f"{drive.name}, {camera}, {model.stem}",
                _Tracked.of(open_frames(), groups, motion_of(drive, camera, labelled.class_names, TrackingConfig())),
                (cameras.index(camera), len(cameras)),
                labelled.class_names,
                table[np.flatnonzero(table.camera == cameras.index(camera))],
                weight / (len(models) * len(found)),
            )


def samples_of_text(root: Path, names: Sequence[str]) -> Iterator[Sample]:
    """The boxes in some sequences of a folder."""
    for sequence in read_sequences(root, config=EvaluationConfig()):
        if sequence.name in names:
            tracked = _Tracked.of(sequence.frames, sequence.class_groups)
            yield _sample(f"{sequence.name}, {CAMERA}", tracked, (0, 1), sequence.class_names, sequence.truth, 1.0)


def fit(samples: Sequence[Sample]) -> CurveModel:
    """The curves that make what came true most probable."""
    kept = [one.outcome[IOUS[-1]] != ABSORBED for one in samples]
    is_right = [np.mean([one.outcome[iou] == HIT for iou in IOUS], axis=0) for one in samples]
    return fit_curves(
        np.concatenate([one.features[of] for one, of in zip(samples, kept, strict=True)]),
        np.concatenate([right[of] for right, of in zip(is_right, kept, strict=True)]),
        np.concatenate(
            [np.full(of.sum(), one.weight / max(of.sum(), 1)) for one, of in zip(samples, kept, strict=True)]
        ),
        names=FEATURES,
        flags=_FLAGS,
        directions=_DIRECTIONS,
    )


def precision_and_recall(samples: Iterable[Sample], model: CurveModel, threshold: float) -> list[tuple[float, float]]:
    """For each of IOUS, of the boxes that are trusted at least so much, or sure themselves, over all samples."""
    hits, false_labels, objects = np.zeros(len(IOUS)), np.zeros(len(IOUS)), 0
    for one in samples:
        kept = one.is_donor | (trust_of(one.features, model) >= threshold)
        hits += [np.count_nonzero(one.outcome[iou][kept] == HIT) for iou in IOUS]
        false_labels += [np.count_nonzero(one.outcome[iou][kept] == FALSE_LABEL) for iou in IOUS]
        objects += one.objects
    return list(zip((hits / (hits + false_labels)).tolist(), (hits / objects).tolist(), strict=True))


@dataclass(frozen=True, eq=False)
class _Tracked:
    """The observations of one camera, and the features (N, F) of each."""

    observations: Sequence[Observations]
    features: NDArray[np.float64]

    @staticmethod
    def of(
        frames: Iterable[DetectedFrame], class_groups: Sequence[int], motion: CameraMotion | None = None
    ) -> _Tracked:
        """Boxes are judged in windows, some twice: the number of its features stands for the trust of each."""
        judged: list[NDArray[np.float64]] = []

        def number(features: NDArray[np.float64]) -> NDArray[np.float64]:
            first = sum(len(one) for one in judged)
            judged.append(features)
            return first + np.arange(len(features), dtype=np.float64)

        tracker = OfflineTracker(TrackingConfig(), class_groups=class_groups, motion=motion, judge=number)
        observations = [Observations.empty(), *tracker.track(frames, first_track_id=1)]
        numbers = np.concatenate([one.trust for one in observations]).astype(np.intp)
        return _Tracked(observations, np.concatenate([np.zeros((0, len(FEATURES))), *judged])[numbers])


def _sample(
    name: str,
    tracked: _Tracked,
    camera: tuple[int, int],
    class_names: tuple[str, ...],
    truth: TruthTable,
    weight: float,
) -> Sample:
    """``camera`` is the camera's number, and how many there are."""
    found = tracked.observations
    track_id = np.concatenate([one.track_id for one in found])
    score = np.nan_to_num(np.concatenate([one.score for one in found]))
    _, place = np.unique(track_id, return_inverse=True)
    best = np.zeros(len(track_id), np.float32)
    np.maximum.at(best, place, score)
    confidence = EvaluationConfig().confidence
    label_class = class_of_labels(class_names)[np.concatenate([one.class_id for one in found])]
    rows = np.flatnonzero((best[place] >= confidence) & (label_class >= 0))
    number = np.full(len(rows), camera[0], np.int16)
    boxes = Labels2D(
        image_number(np.concatenate([one.frame_index for one in found])[rows], number, camera[1]),
        number,
        np.concatenate([one.xyxy_px for one in found])[rows],
        label_class[rows],
        best[place][rows],
    )
    pairs = overlapping_pairs(boxes.image, boxes.xyxy_px, truth.image, truth.whole_px)
    outcome = {iou: judge(boxes, truth, pairs, min_iou=iou, compare_classes=False).outcome for iou in IOUS}
    objects = int(np.count_nonzero(truth.counted))
    return Sample(name, tracked.features[rows], outcome, score[rows] >= confidence, objects, weight)


def _say(title: str, samples: Sequence[Sample], model: CurveModel) -> None:
    if not samples:
        return
    sys.stdout.write(f"{title}: trusted at least so much, precision and recall at IoU .25, at .5\n")
    for threshold in _THRESHOLDS:
        (p25, r25), (p50, r50) = precision_and_recall(samples, model, threshold)
        sys.stdout.write(f"  {threshold:.2f}: {p25:.3f} {r25:.3f}, {p50:.3f} {r50:.3f}\n")


def main() -> None:
    """Fit on some sequences and drives, check on others, write the model."""
    options = parse_options(__doc__)

    def of_drives(folders: Sequence[Path]) -> list[Sample]:
        found = (samples_of_drive(one, models=options.models, workspace=options.workspace) for one in folders)
        return list(chain.from_iterable(found))

    model = shipped()
    if options.out is not None:
        text, drives = options.of_text(options.text_fit, samples_of_text), of_drives(options.fit)
        model = fit([*text, *drives])
        options.write(model)
        _say("sequences that it was fitted on", text, model)
        _say("drives that it was fitted on", drives, model)
    _say("other sequences", options.of_text(options.text_check, samples_of_text), model)
    _say("other drives", of_drives(options.check), model)


if __name__ == "__main__":
    main()
