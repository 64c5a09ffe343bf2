"""Fits the calibration of merges, and says how well it holds: the probability of a pair against what came true.

Candidates come from made observations, of which the truth is known: of each drive with its own rig and with others, at
its own rate and at lower ones, with several strengths and seeds of noise, with and without LiDAR; and from what real
detectors and trackers make of the images of other drives. Each curve is fitted under the direction that sense demands
(farther apart is never more probably one object), so that it holds beyond what was seen, and a ridge keeps curves flat
where nothing speaks for a bend.

    python -m labeler.evaluation.calibrate_merges --fit DRIVE ... --fit-detected DRIVE ... --check DRIVE ...
        --check-detected DRIVE ... --model MODEL ... --workspace FOLDER --out calibration.json
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise, product
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import expit

from labeler.drive import open_drive, open_truth
from labeler.evaluation.benchmark_merges import track_scene
from labeler.evaluation.made_observations import Noise, Scene, scene_of
from labeler.evaluation.made_observations.rigs import RIGS, every_nth_frame, with_rig
from labeler.evaluation.owned_tracks import OwnedTracks, of_detector, of_scene
from labeler.identity.calibration import Calibration, Curve, KindModel
from labeler.identity.config import IdentityConfig
from labeler.identity.features import FEATURES, Candidate
from labeler.identity.merging import gather
from labeler.identity.types import MergeKind
from labeler.pipeline import LabelSettings
from labeler.tracking import TrackingConfig

_MAX_KNOTS = 8
_RIDGE = 1.0
_DETECTED_WEIGHT = 4
"""So often does a detector's pair count: there are fewer of them than of made ones, and they are what users have."""
_FALLS, _RISES = -1, 1
_DIRECTION = {
    "distance_sigmas": _FALLS,
    "distance_m": _FALLS,
    "agreeing_share": _RISES,
    "rival_share": _FALLS,
    "outside_box": _FALLS,
    "apart_share": _FALLS,
    "velocity_difference_mps": _FALLS,
    "size_difference": _FALLS,
    "class_agreement": _RISES,
    "colour_likeness": _RISES,
    "gap_distance_sigmas": _FALLS,
    "gap_distance_m": _FALLS,
    "velocity_sigmas": _FALLS,
    "gap_s": _FALLS,
    "still_distance_m": _FALLS,
    "place_density": _RISES,
    "rival_density": _RISES,
    "weaker_score": _RISES,
}
"""Where a feature may only speak more, or only less, for one object as it grows."""
RELIABILITY_EDGES = (0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97, 0.99, 1.0)


@dataclass(frozen=True, eq=False)
class Sample:
    """Candidates of one kind: ``values`` (N, K) and ``is_one`` (N,) bool whether both tracks are of one object."""

    values: NDArray[np.float64]
    is_one: NDArray[np.bool_]

    @staticmethod
    def joined(samples: Sequence[Sample]) -> Sample:
        """All of them as one."""
        return Sample(np.concatenate([one.values for one in samples]), np.concatenate([one.is_one for one in samples]))


def conditions(scene: Scene, seed: int) -> Iterator[tuple[Scene, Noise]]:
    """A scene under several rigs, rates, noises; the noise's seeds follow from ``seed``."""
    yield scene, Noise(1.0, seed)
    yield every_nth_frame(scene, 2), Noise(0.6, seed + 1)
    yield scene, Noise(1.6, seed + 2)
    yield scene, Noise(1.0, seed + 3, lidar=False)
    for number, rig in enumerate(RIGS):
        level = (0.7, 1.0, 1.4)[(seed + number) % 3]
        step = (1, 2, 4)[(seed // 3 + number) % 3]
        yield every_nth_frame(with_rig(scene, rig), step), Noise(level, seed + 10 + number)


def samples_of(tracks: OwnedTracks) -> dict[MergeKind, Sample]:
    """The candidates among tracks with what is true of them; without those of which that is not clear."""
    config = IdentityConfig()
    gathered = gather(tracks.frames, config, class_groups=tracks.class_groups, rig=tracks.rig, colours=tracks.colours)
    by_kind: dict[MergeKind, list[Candidate]] = {kind: [] for kind in MergeKind}
    for candidate in gathered.candidates(config):
        if candidate.track_a in tracks.object_of and candidate.track_b in tracks.object_of:
            by_kind[candidate.kind].append(candidate)
    found: dict[MergeKind, Sample] = {}
    for kind, candidates in by_kind.items():
        owners = [(tracks.object_of[one.track_a], tracks.object_of[one.track_b]) for one in candidates]
        values = np.array([one.values for one in candidates]).reshape(-1, len(FEATURES[kind]))
        found[kind] = Sample(values, np.array([a == b and a is not None for a, b in owners], np.bool_))
    return found


def fit(samples: dict[MergeKind, Sample]) -> Calibration:
    """The curves that make what came true most probable."""
    return Calibration({kind: _fit_kind(kind, sample) for kind, sample in samples.items()})


def reliability(
    calibration: Calibration, samples: dict[MergeKind, Sample]
) -> list[tuple[str, float, float, int, float]]:
    """(kind, from, to, how many pairs, which share of them came true) for each step of probability that has any."""
    rows: list[tuple[str, float, float, int, float]] = []
    for kind, sample in samples.items():
        probability = expit(calibration.log_odds(kind, sample.values)[0])
        for low, high in pairwise(RELIABILITY_EDGES):
            inside = (probability >= low) & (probability < high)
            if inside.any():
                rows.append((kind.value, low, high, int(inside.sum()), float(sample.is_one[inside].mean())))
    return rows


def _fit_kind(kind: MergeKind, sample: Sample) -> KindModel:
    names = [name for name, _ in FEATURES[kind]]
    knots = [_knots(sample.values[:, column], sample.is_one) for column in range(len(names))]
    design = [_hats(sample.values[:, column], at) for column, at in enumerate(knots)]
    # A curve is its level at the first knot and steps from knot to knot: a direction is a bound on the steps.
    steps = [hats @ np.tri(len(at)) for hats, at in zip(design, knots, strict=True)]
    matrix = np.concatenate([np.ones((len(sample.values), 1)), *steps], axis=1)
    bounds: list[tuple[float | None, float | None]] = [(None, None)]
    for name, at in zip(names, knots, strict=True):
        direction = _DIRECTION.get(name, 0)
        step = {_FALLS: (None, 0.0), _RISES: (0.0, None), 0: (None, None)}[direction]
        bounds += [(None, None), *[step] * (len(at) - 1)]
    target = sample.is_one.astype(float)

    def loss(weights: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        z = matrix @ weights
        ridge = _RIDGE * weights
        ridge[0] = 0.0
        value = float(np.logaddexp(0, z).sum() - target @ z + ridge @ weights / 2)
        return value, matrix.T @ (expit(z) - target) + ridge

    found = minimize(
        loss, np.zeros(matrix.shape[1]), jac=True, method="L-BFGS-B", bounds=bounds, options={"maxiter": 800}
    )
    weights = np.asarray(found.x, np.float64)
    bias, at = float(weights[0]), 1
    curves: list[Curve] = []
    for column, of_curve in enumerate(knots):
        log_odds = np.cumsum(weights[at : at + len(of_curve)])
        at += len(of_curve)
        if not np.isnan(sample.values[:, column]).any():  # its middle is no news: that belongs to the bias
            middle = float(np.interp(np.median(sample.values[:, column]), of_curve, log_odds))
            log_odds, bias = log_odds - middle, bias + middle
        curves.append(Curve(of_curve, log_odds))
    return KindModel(bias, tuple(curves))


def _knots(values: NDArray[np.float64], is_one: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Where a curve may bend: at even shares of the pairs of either kind, so that both are well told apart."""
    known = ~np.isnan(values)
    shares = np.linspace(0.01, 0.99, _MAX_KNOTS // 2)
    parts = [np.quantile(values[chosen], shares) for chosen in (known & is_one, known & ~is_one) if chosen.any()]
    knots = np.unique(np.round(np.concatenate([np.zeros(0), *parts]), 4))
    if len(knots) < 2:
        return np.array([0.0, 1.0])
    gap = (knots[-1] - knots[0]) / (4 * _MAX_KNOTS)
    kept = [float(knots[0])]
    for knot in knots[1:].tolist():
        if knot - kept[-1] >= gap:
            kept.append(knot)
    return np.array(kept) if len(kept) > 1 else np.array([kept[0], kept[0] + 1.0])


def _hats(values: NDArray[np.float64], knots: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, K) how much of a value's curve comes from each knot; rows of NaN are 0."""
    clipped = np.clip(np.nan_to_num(values, nan=knots[0]), knots[0], knots[-1])
    right = np.clip(np.searchsorted(knots, clipped, side="right"), 1, len(knots) - 1)
    share = (clipped - knots[right - 1]) / (knots[right] - knots[right - 1])
    hats = np.zeros((len(values), len(knots)))
    rows = np.arange(len(values))
    hats[rows, right - 1] = 1 - share
    hats[rows, right] += share
    hats[np.isnan(values)] = 0
    return hats


def _made(drives: Sequence[Path], first_seed: int, max_frames: int | None) -> Iterator[OwnedTracks]:
    """Tracks of made observations."""
    for number, path in enumerate(drives):
        scene = scene_of(open_truth(path), max_frames=max_frames)
        for changed, noise in conditions(scene, first_seed + 100 * number):
            yield of_scene(track_scene(changed, noise, TrackingConfig()))
        sys.stderr.write(f"{path.name} done\n")


def _detected(drives: Sequence[Path], models: Sequence[Path], workspace: Path | None) -> Iterator[OwnedTracks]:
    """Tracks of each model's detections."""
    for path, model in product(drives, models):
        assert workspace is not None
        yield of_detector(open_drive(path), model, workspace=workspace, settings=LabelSettings())
        sys.stderr.write(f"{path.name}, {model.name} done\n")


def _gather(*sources: tuple[Iterable[OwnedTracks], int]) -> dict[MergeKind, Sample]:
    """The candidates of all tracks, each as often as its source weighs."""
    samples: list[dict[MergeKind, Sample]] = []
    for tracks, weight in sources:
        for some in tracks:
            samples += [samples_of(some)] * weight
    return {kind: Sample.joined([of_some[kind] for of_some in samples]) for kind in MergeKind}


def main() -> None:
    """Fit on some drives, check on others, write the calibration."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fit", type=Path, nargs="+", required=True, help="drives with 3D truth to fit on")
    parser.add_argument("--check", type=Path, nargs="+", required=True, help="other drives, for the reliability table")
    parser.add_argument("--frames", type=int, help="use the first frames of each of these drives only")
    parser.add_argument("--fit-detected", type=Path, nargs="*", default=[], help="drives with images, to fit on")
    parser.add_argument("--check-detected", type=Path, nargs="*", default=[], help="other drives with images")
    parser.add_argument("--model", type=Path, nargs="*", default=[], help="detectors to run on these")
    parser.add_argument("--workspace", type=Path, help="folder for what the detectors find")
    parser.add_argument("--out", type=Path, required=True, help="the calibration to write")
    options = parser.parse_args()
    if (options.fit_detected or options.check_detected) and not (options.model and options.workspace):
        parser.error("--fit-detected and --check-detected need --model and --workspace")
    detected = partial(_detected, models=options.model, workspace=options.workspace)
    samples = _gather((_made(options.fit, 0, options.frames), 1), (detected(options.fit_detected), _DETECTED_WEIGHT))
    for kind, sample in samples.items():
        sys.stdout.write(f"{kind.value}: {len(sample.is_one)} pairs, {int(sample.is_one.sum())} of one object\n")
    calibration = fit(samples)
    options.out.write_text(json.dumps(calibration.to_json(), indent=1) + "\n", encoding="utf-8")
    checks = {
        "made": _made(options.check, 50_000, options.frames),
        "detected": detected(options.check_detected),
    }
    for source, tracks in checks.items():
        for kind, low, high, count, share in reliability(calibration, _gather((tracks, 1))):
            sys.stdout.write(f"{source:8} {kind:9} {low:4.2f} to {high:4.2f}: {count:6} pairs, {share:.3f} came true\n")


if __name__ == "__main__":
    main()
