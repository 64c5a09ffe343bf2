"""How far labels can be believed where there is no truth: hide some that are known, and look what becomes of them.

A random share of the confident observations loses its detections. Tracking, merging and propagation run again without
them, on copies, and each hidden detection is compared with what then stands at its place: is there a box that overlaps
it by at least half, and has that box its class? What was hidden is what the detector is sure of, so the answer is about
objects that are seen well now and then, and not about those that no detection ever shows.

All streams: who is hidden follows from the seed, the camera and the frame, so no list of them is kept.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Generic, TypedDict, TypeVar

import numpy as np
from numpy.typing import NDArray

from labeler.detection.types import Detections
from labeler.drive.types import Drive
from labeler.evaluation.types import EvaluationError
from labeler.geometry.boxes_2d import iou_matrix
from labeler.identity import CameraView, MultiCameraFrame
from labeler.identity.config import BASELINE
from labeler.pipeline import plan
from labeler.pipeline.colouring import measure_colours
from labeler.pipeline.detecting import read_detections
from labeler.pipeline.reading import read_labelled_frames, read_observations, read_views
from labeler.pipeline.results import ResultFiles
from labeler.pipeline.types import LabelledView, Progress, SilentProgress
from labeler.pipeline.units import (
    DonorUnit,
    IdentityUnit,
    LabelUnit,
    choose_donors,
    find_identities,
    label_camera,
    track_detections,
)
from labeler.tracking import NO_DETECTION, DetectedFrame, Observations

MIN_IOU = 0.5
USUAL_SHARE, LARGEST_USUAL_SHARE = 0.05, 0.2
"""How much is hidden unless told otherwise; of a short drive more, but never so much that tracking becomes another."""

FEW_HIDDEN = 20
"""With fewer hidden observations the intervals are so wide that hardly anything is known."""

_AIMED_HIDDEN = 40

DISTANCES_M = (0.0, 10.0, 20.0, 40.0, 60.0, 80.0, math.inf)
HEIGHTS_PX = (0.0, 20.0, 40.0, 80.0, 160.0, math.inf)
STAGE = "audit"
_Z_95 = 1.959964

Item = TypeVar("Item")


@dataclass(frozen=True)
class AuditConfig:
    """``share`` of the observations whose score is at least ``confidence`` is hidden; who follows from ``seed``. A
    share of None is USUAL_SHARE, or, where that would be few observations, up to LARGEST_USUAL_SHARE."""

    share: float | None = None
    confidence: float = 0.8
    seed: int = 0

    def __post_init__(self) -> None:
        if self.share is not None and not 0 < self.share <= 0.5:
            raise EvaluationError(f"The share to hide must be above 0 and at most 0.5, got {self.share}.")
        if not 0 <= self.confidence <= 1:
            raise EvaluationError(f"The confidence must be from 0 to 1, got {self.confidence}.")
        if self.seed < 0:
            raise EvaluationError(f"The seed must not be negative, got {self.seed}.")


class Agreement(TypedDict):
    """``agree`` of ``of``, their share, and the interval that holds the true share in 95 of 100 cases (Wilson's); None
    of nothing."""

    agree: int
    of: int
    share: float | None
    low: float | None
    high: float | None


class AuditRow(TypedDict):
    """Hidden observations whose value is at least ``start`` and below ``stop``, None without an end. ``box``: a box is
    there; ``label``: it has the hidden one's class, of those that are there."""

    start: float
    stop: float | None
    box: Agreement
    label: Agreement


class Audit(TypedDict):
    """What ``hindsight audit --json`` prints. ``confident`` observations are those that could have been hidden, and
    ``share`` of them was to be."""

    drive: str
    share: float
    confidence: float
    seed: int
    iou: float
    confident: int
    hidden: int
    box: Agreement
    label: Agreement
    by_distance: list[AuditRow]
    by_height: list[AuditRow]


def audit_labels(
    drive: Drive, files: ResultFiles, *, config: AuditConfig | None = None, progress: Progress | None = None
) -> Audit:
    """Audit a result of the pipeline. The result itself is only read.

    Raises EvaluationError where nothing is hidden, and Cancelled as the pipeline does.
    """
    config = config or AuditConfig()
    progress = progress or SilentProgress()
    share = config.share or _usual_share(files, config)
    counted = _Counted()
    numbers = {camera: number for number, camera in enumerate(files.detections, start=1)}
    progress.stage(STAGE, len(files.detections) + 2)
    with TemporaryDirectory(prefix="hindsight-audit-") as folder:
        again = _label_without_hidden(drive, files, config, share, Path(folder), progress)
        compared = _frames_in_step(read_views(files.tracks, files.boxes_3d), again)
        detections = {camera: _InOrder(_by_frame(read_detections(paths))) for camera, paths in files.detections.items()}
        for frame_index, views, views_again in compared:
            for camera, view in views.items():
                counted.confident += int(np.count_nonzero(_confident(view.observations, config)))
                rows = np.flatnonzero(_hidden(view.observations, numbers[camera], frame_index, config, share))
                seen = detections[camera].at(frame_index)
                if len(rows) and seen is not None:
                    counted.add(view, rows, seen, views_again.get(camera))
        progress.advance()
    if counted.hidden == 0:
        raise EvaluationError(
            f"None of {counted.confident} observations with a confidence of at least {config.confidence:g} would be "
            "hidden, so there is nothing to tell. Hide a larger share, or ask for less confidence."
        )
    return counted.audit(drive.name, config, share)


def _usual_share(files: ResultFiles, config: AuditConfig) -> float:
    """The share to hide where none is asked for."""
    confident = sum(
        int(np.count_nonzero(_confident(observations, config)))
        for path in files.tracks.values()
        for _, observations in read_observations(path)
    )
    return min(LARGEST_USUAL_SHARE, max(USUAL_SHARE, round(_AIMED_HIDDEN / max(confident, 1), 3)))


def _label_without_hidden(
    drive: Drive, files: ResultFiles, config: AuditConfig, share: float, folder: Path, progress: Progress
) -> Iterator[tuple[int, Mapping[str, LabelledView]]]:
    """Track, merge and propagate without the hidden detections, in files of ``folder``; the labelled frames."""
    tracks: dict[str, Path] = {}
    for number, (camera, paths) in enumerate(files.detections.items(), start=1):
        tracks[camera] = folder / f"tracks-{number}.arrow"
        observed = read_observations(files.tracks[camera])
        frames = _without_hidden(read_detections(paths), observed, number, config, share)
        track_detections(
            frames,
            tracks[camera],
            files.tracking,
            class_groups=files.class_groups,
            first_track_id=plan.first_track_id(number),
            motion=plan.motion_of(drive, camera, files.class_names, files.tracking) if files.class_names else None,
        )
        progress.advance()
    identities, donors = folder / "identities.json", folder / "donors.json"
    rig, times_ns = plan.rig_of(drive), plan.frame_times_of(drive)
    colours = _colours(drive, tracks, files, folder)
    merging = IdentityUnit(
        "", tracks, files.boxes_3d, colours, files.identity, files.class_groups, rig, files.decisions
    )
    find_identities(merging, identities)
    choose_donors(DonorUnit("", tracks, identities, files.propagation, times_ns), donors)
    labels = {camera: folder / f"labels-{number}.arrow" for number, camera in enumerate(tracks)}
    for camera, path in labels.items():
        label_camera(LabelUnit("", tracks[camera], identities, donors, files.propagation, times_ns), path)
    progress.advance()
    return ((frame.frame_index, frame.views) for frame in read_labelled_frames(tracks, labels, files.boxes_3d))


def _colours(drive: Drive, tracks: Mapping[str, Path], files: ResultFiles, folder: Path) -> tuple[Path, ...]:
    """The colours of these tracks, in files of ``folder``, where merging looked at colours."""
    if files.identity.method == BASELINE:
        return ()
    paths: list[Path] = []
    for number, unit in enumerate(plan.colour_units(drive, tracks)):
        paths.append(folder / f"colours-{number}.arrow")
        measure_colours(unit, paths[-1])
    return tuple(paths)


def _confident(observations: Observations, config: AuditConfig) -> NDArray[np.bool_]:
    """(N,) whether an observation may be hidden: it was detected, and the detector was sure."""
    with np.errstate(invalid="ignore"):
        return (observations.detection_index != NO_DETECTION) & (observations.score >= config.confidence)


def _hidden(
    observations: Observations, camera_number: int, frame_index: int, config: AuditConfig, share: float
) -> NDArray[np.bool_]:
    """(N,) whether an observation is hidden; always the same for the same seed, camera and frame."""
    random = np.random.default_rng((config.seed, camera_number, frame_index)).random(len(observations))
    return _confident(observations, config) & (random < share)


def _without_hidden(
    frames: Iterable[DetectedFrame],
    observed: Iterator[tuple[int, Observations]],
    camera_number: int,
    config: AuditConfig,
    share: float,
) -> Iterator[DetectedFrame]:
    """The frames of a camera; a hidden detection keeps its row, so that the others keep theirs, but has no score, which
    no tracker takes."""
    tracks = _InOrder(observed)
    for frame in frames:
        observations = tracks.at(frame.frame_index)
        if observations is not None:
            hidden = _hidden(observations, camera_number, frame.frame_index, config, share)
            score = frame.detections.score.copy()
            score[observations.detection_index[hidden]] = np.nan
            frame = replace(frame, detections=replace(frame.detections, score=score))
        yield frame


class _InOrder(Generic[Item]):
    """Items by frame, for frames that are asked for in order."""

    def __init__(self, items: Iterator[tuple[int, Item]]) -> None:
        self._items = items
        self._next = next(items, None)

    def at(self, frame_index: int) -> Item | None:
        while self._next is not None and self._next[0] < frame_index:
            self._next = next(self._items, None)
        return self._next[1] if self._next is not None and self._next[0] == frame_index else None


def _by_frame(frames: Iterable[DetectedFrame]) -> Iterator[tuple[int, Detections]]:
    return ((frame.frame_index, frame.detections) for frame in frames)


def _frames_in_step(
    before: Iterable[MultiCameraFrame], again: Iterator[tuple[int, Mapping[str, LabelledView]]]
) -> Iterator[tuple[int, Mapping[str, CameraView], Mapping[str, LabelledView]]]:
    """(frame_index, views before, views without what was hidden) of every frame with views before."""
    views_again = _InOrder(again)
    for frame in before:
        yield frame.frame_index, frame.views, views_again.at(frame.frame_index) or {}


class _Counted:
    """What became of the hidden observations: boxes and labels that agree, by distance and by height."""

    def __init__(self) -> None:
        self.confident = 0
        self.hidden = 0
        self._whole = _Bins((-math.inf, math.inf))
        self._by_distance = _Bins(DISTANCES_M)
        self._by_height = _Bins(HEIGHTS_PX)

    def add(self, view: CameraView, rows: NDArray[np.intp], seen: Detections, again: LabelledView | None) -> None:
        """Compare the hidden ``rows`` of one image; ``seen`` are its detections, ``again`` None where nothing is."""
        hidden = view.observations.detection_index[rows]
        box_px, class_id = seen.xyxy_px[hidden].astype(np.float64), seen.class_id[hidden]
        box_agrees = np.zeros(len(rows), np.bool_)
        label_agrees = np.zeros(len(rows), np.bool_)
        if again is not None and len(again.observations):
            overlap = iou_matrix(box_px, again.observations.xyxy_px.astype(np.float64))
            nearest = overlap.argmax(axis=1)
            box_agrees = overlap.max(axis=1) >= MIN_IOU
            labels = again.labels
            label_agrees = box_agrees & np.isfinite(labels.score[nearest]) & (labels.class_id[nearest] == class_id)
        self.hidden += len(rows)
        self._whole.add(np.zeros(len(rows)), box_agrees, label_agrees)
        self._by_height.add(box_px[:, 3] - box_px[:, 1], box_agrees, label_agrees)
        self._by_distance.add(_distances_m(view, hidden), box_agrees, label_agrees)

    def audit(self, drive_name: str, config: AuditConfig, share: float) -> Audit:
        (whole,) = self._whole.rows()
        return Audit(
            drive=drive_name,
            share=share,
            confidence=config.confidence,
            seed=config.seed,
            iou=MIN_IOU,
            confident=self.confident,
            hidden=self.hidden,
            box=whole["box"],
            label=whole["label"],
            by_distance=self._by_distance.rows(),
            by_height=self._by_height.rows(),
        )


class _Bins:
    """Counts by a value: hidden observations, those with a box, those with the label as well."""

    def __init__(self, edges: tuple[float, ...]) -> None:
        self._edges = edges
        self._hidden = np.zeros(len(edges) - 1, np.int64)
        self._boxes = np.zeros(len(edges) - 1, np.int64)
        self._labels = np.zeros(len(edges) - 1, np.int64)

    def add(self, value: NDArray[np.float64], box: NDArray[np.bool_], label: NDArray[np.bool_]) -> None:
        """Count rows by ``value`` (N,); those where it is NaN are in no bin."""
        known = ~np.isnan(value)
        place = np.searchsorted(self._edges, value[known], side="right") - 1
        count = len(self._hidden)
        self._hidden += np.bincount(place, minlength=count)
        self._boxes += np.bincount(place[box[known]], minlength=count)
        self._labels += np.bincount(place[label[known]], minlength=count)

    def rows(self) -> list[AuditRow]:
        """A row for each bin that has any."""
        return [
            AuditRow(
                start=start,
                stop=None if math.isinf(stop) else stop,
                box=agreement(int(self._boxes[place]), int(self._hidden[place])),
                label=agreement(int(self._labels[place]), int(self._boxes[place])),
            )
            for place, (start, stop) in enumerate(pairwise(self._edges))
            if self._hidden[place]
        ]


def agreement(agree: int, of: int) -> Agreement:
    """The share, and its interval by E. B. Wilson (1927), which holds for shares near 0 and 1 and for few as well."""
    if of == 0:
        return Agreement(agree=0, of=0, share=None, low=None, high=None)
    share = agree / of
    middle = (share + _Z_95**2 / (2 * of)) / (1 + _Z_95**2 / of)
    half = _Z_95 * math.sqrt(share * (1 - share) / of + _Z_95**2 / (4 * of**2)) / (1 + _Z_95**2 / of)
    return Agreement(
        agree=agree,
        of=of,
        share=round(share, 4),
        low=round(max(0.0, middle - half), 4),
        high=round(min(1.0, middle + half), 4),
    )


def _distances_m(view: CameraView, detection_index: NDArray[np.int32]) -> NDArray[np.float64]:
    """(N,) how far from the car detections stand, in the plane; NaN where it is not known."""
    positions = view.positions
    distance_m = np.full(len(detection_index), np.nan)
    if len(positions):
        order = np.argsort(positions.detection_index, kind="stable")
        at = np.searchsorted(positions.detection_index[order], detection_index)
        row = order[np.minimum(at, len(order) - 1)]
        known = positions.detection_index[row] == detection_index
        distance_m[known] = np.hypot(*positions.position_m[row[known], :2].astype(np.float64).T)
    return distance_m
