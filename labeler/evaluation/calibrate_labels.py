"""Fits how likely labels are right (:mod:`labeler.propagation.probability`), and says how well it holds on others.

Labels come from drives with truth, labelled as ``hindsight label`` does (what the workspace has of them is used again),
and from text sequences with detections and truth (:mod:`labeler.evaluation.text_sequences`). Drives and sequences count
alike, however long they are. A label is right where it hits a true object at an IoU of .5, class and all, as in
``hindsight evaluate``. Curves are held to the direction that sense demands: a box that is trusted more never makes its
label less likely.

    python -m labeler.evaluation.calibrate_labels --model FILE ... --workspace FOLDER --fit DRIVE ... --check DRIVE ...
        --text ROOT --text-fit 0000 ... --text-check 0001 ... --out probability.json
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from labeler.drive import open_drive
from labeler.evaluation.calibration_command import parse_options
from labeler.evaluation.categories import class_of_labels
from labeler.evaluation.counting import ABSORBED, HIT, Labels2D, judge
from labeler.evaluation.curve_fitting import FALLS, RISES, fit_curves
from labeler.evaluation.matching import overlapping_pairs
from labeler.evaluation.reliability import Reliability, ReliabilityCounts
from labeler.evaluation.text_sequences import CAMERA, read_sequences
from labeler.evaluation.truth import TruthTable, image_number, true_boxes_of
from labeler.evaluation.types import EvaluationConfig
from labeler.evaluation.usual_labelling import label_as_usual
from labeler.propagation import collect_votes, label_observations
from labeler.propagation.labelling import label_features
from labeler.propagation.probability import FEATURES, probability_of, shipped
from labeler.tracking import Observations, TrackingConfig, open_tracker
from labeler.tracking.curves import CurveModel

MIN_IOU = 0.5
_FLAGS = ("filled", "other_class")
_DIRECTIONS = {
    "donor_score": RISES,
    "own_score": RISES,
    "other_class": FALLS,
    "trust": RISES,
    "donor_s": FALLS,
    "class_share": RISES,
    "cameras": RISES,
}
"""Where a feature may only speak more, or only less, for a label as it grows."""


@dataclass(frozen=True, eq=False)
class Sample:
    """Labels of one drive or sequence: ``features`` (N, F), whether each is right (N,), its confidence (N,)."""

    name: str
    features: NDArray[np.float64]
    is_right: NDArray[np.bool_]
    confidence: NDArray[np.float32]


def sample_of_drive(folder: Path, *, model: Path, workspace: Path) -> Sample:
    """The labels of a drive that comes with true boxes in its images; EvaluationError where it doesn't."""
    drive = open_drive(folder)
    cameras = tuple(camera.name for camera in drive.cameras)
    table = true_boxes_of(drive, EvaluationConfig())
    labelled = label_as_usual(drive, model=model, workspace=workspace)
    seen = [
        (camera, view.observations)
        for frame in labelled.frames()
        for camera, view in frame.views.items()
        if len(view.observations)
    ]
    times_ns = np.array([frame.timestamp_ns for frame in drive.frames], np.int64)
    return _sample(
        f"{drive.name}, {model.stem}", seen, labelled.identity_of, times_ns, cameras, labelled.class_names, table
    )


def samples_of_text(root: Path, names: Sequence[str]) -> Iterator[Sample]:
    """The labels of some sequences of a folder, tracked as ``hindsight benchmark labels`` does."""
    for sequence in read_sequences(root, config=EvaluationConfig()):
        if sequence.name not in names:
            continue
        tracker = open_tracker(TrackingConfig(), class_groups=sequence.class_groups)
        seen = [(CAMERA, found) for found in tracker.track(sequence.frames, first_track_id=1) if len(found)]
        times_ns = np.array([frame.timestamp_ns for frame in sequence.frames], np.int64)
        yield _sample(sequence.name, seen, {}, times_ns, (CAMERA,), sequence.class_names, sequence.truth)


def fit(samples: Sequence[Sample]) -> CurveModel:
    """The curves that make what came true most probable; every sample has the same weight."""
    return fit_curves(
        np.concatenate([one.features for one in samples]),
        np.concatenate([one.is_right for one in samples]).astype(np.float64),
        np.concatenate([np.full(len(one.is_right), 1 / max(len(one.is_right), 1)) for one in samples]),
        names=FEATURES,
        flags=_FLAGS,
        directions=_DIRECTIONS,
    )


def reliability_of(samples: Sequence[Sample], model: CurveModel | None) -> Reliability:
    """How well probabilities of a model hold; without one, the paper's confidences taken for such."""
    counts = ReliabilityCounts()
    for one in samples:
        said = one.confidence if model is None else probability_of(one.features, model)
        counts.add(said, one.is_right)
    return counts.reliability()


def _sample(
    name: str,
    seen: Sequence[tuple[str, Observations]],
    identity_of: Mapping[int, int],
    times_ns: NDArray[np.int64],
    cameras: Sequence[str],
    class_names: Sequence[str],
    truth: TruthTable,
) -> Sample:
    votes = collect_votes(seen, identity_of, timestamp_ns=times_ns)
    found = [one for _, one in seen]
    labels = [label_observations(one, identity_of, votes, timestamp_ns=times_ns) for one in found]
    features = [label_features(one, its, votes, times_ns) for one, its in zip(found, labels, strict=True)]
    camera = np.repeat(np.array([cameras.index(one) for one, _ in seen], np.int16), [len(one) for one in found])
    class_id = np.concatenate([np.zeros(0, np.int16), *(one.class_id for one in labels)])
    boxes = Labels2D(
        image_number(
            np.concatenate([np.zeros(0, np.int32), *(one.frame_index for one in found)]), camera, len(cameras)
        ),
        camera,
        np.concatenate([np.zeros((0, 4), np.float32), *(one.xyxy_px for one in found)]),
        class_of_labels(tuple(class_names))[class_id],
        np.concatenate([np.zeros(0, np.float32), *(one.score for one in labels)]),
    )
    pairs = overlapping_pairs(boxes.image, boxes.xyxy_px, truth.image, truth.whole_px)
    judged = judge(boxes, truth, pairs, min_iou=MIN_IOU, compare_classes=True)
    kept = boxes.counted & (judged.outcome != ABSORBED)
    of_all = np.concatenate([np.zeros((0, len(FEATURES))), *features])
    return Sample(name, of_all[kept], judged.outcome[kept] == HIT, boxes.score[kept])


def _say(title: str, found: Reliability) -> None:
    sys.stdout.write(f"{title}: {found['labels']} labels, expected calibration error {found['expected_error']}\n")
    for one in found["bins"]:
        if one["labels"]:
            sys.stdout.write(
                f"  {one['start']:.1f} to {one['stop']:.1f}: {one['labels']:6} labels, said {one['predicted']:.3f}, "
                f"came true {one['observed']:.3f}\n"
            )


def main() -> None:
    """Fit on some drives and sequences, check on others, write the model."""
    options = parse_options(__doc__)

    def samples(drives: Sequence[Path], sequences: Sequence[str]) -> list[Sample]:
        seen = product(drives, options.models)
        found = [sample_of_drive(one, model=model, workspace=options.workspace) for one, model in seen]
        return [*found, *options.of_text(sequences, samples_of_text)]

    model = shipped()
    if options.out is not None:
        fitted_on = samples(options.fit, options.text_fit)
        model = fit(fitted_on)
        options.write(model)
        _say("fitted on", reliability_of(fitted_on, model))
    for one in samples(options.check, options.text_check):
        _say(one.name, reliability_of([one], model))
        _say(f"{one.name}, the paper's confidence", reliability_of([one], None))


if __name__ == "__main__":
    main()
