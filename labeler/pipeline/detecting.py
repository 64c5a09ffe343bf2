"""Detection over a drive: images in, one table of detections for each camera and clip of frames."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from labeler.detection import Detections, Detector
from labeler.drive import Camera, DriveFileError, ImageFile, read_image
from labeler.pipeline.artifacts import Artifacts
from labeler.pipeline.tables import (
    columns_of,
    concatenate,
    read_batches,
    read_note,
    rows_by_frame,
    rows_of,
    write_table,
)
from labeler.pipeline.threads import in_threads
from labeler.pipeline.types import Progress
from labeler.tracking import DetectedFrame

STAGE = "detect"
VERSION = 1


@dataclass(frozen=True)
class DetectUnit:
    """A clip of one camera: its number, its images with their frames, and a key of what the detections depend on."""

    key: str
    camera: Camera
    clip: int
    images: tuple[tuple[int, ImageFile], ...]


@dataclass(frozen=True)
class DetectReport:
    """The artifacts, in the order of the units, and the seconds inside the detector over all threads."""

    paths: list[Path]
    detector_seconds: float


@dataclass(frozen=True)
class _Batch:
    unit: DetectUnit
    images: tuple[tuple[int, ImageFile], ...]
    is_last: bool


@dataclass(frozen=True)
class _BatchResult:
    frames: list[tuple[int, int, Detections]]
    warnings: list[str]
    detector_seconds: float


def detect(
    units: Sequence[DetectUnit], detector: Detector, *, artifacts: Artifacts, threads: int, progress: Progress
) -> DetectReport:
    """Detect in every unit that has no artifact yet. An image that can't be read is skipped and noted."""
    paths = [artifacts.path(STAGE, f"{unit.key}-{VERSION}", "arrow") for unit in units]
    left = [(unit, path) for unit, path in zip(units, paths, strict=True) if not path.exists()]
    progress.stage(STAGE, sum(len(unit.images) for unit, _ in left))
    path_of = {unit.key: path for unit, path in left}
    seconds = 0.0
    done: list[_BatchResult] = []
    batches = _batches([unit for unit, _ in left], detector.batch_size)
    for batch, result in in_threads(partial(_detect_batch, detector), batches, threads=threads, name=STAGE):
        seconds += result.detector_seconds
        done.append(result)
        if batch.is_last:
            _write_clip(path_of[batch.unit.key], done, artifacts)
            done = []
        progress.advance(len(batch.images))
    return DetectReport(paths, seconds)


def read_detections(paths: Sequence[Path]) -> Iterator[DetectedFrame]:
    """The frames of one camera in order, from the artifacts of its clips, without those whose image was skipped."""
    for path in paths:
        note = read_note(path)
        rows = dict(rows_by_frame(read_batches(path)))
        for frame_index, timestamp_ns in zip(note["frames"], note["timestamps_ns"], strict=True):
            found = rows.get(frame_index)
            yield DetectedFrame(frame_index, timestamp_ns, rows_of(Detections, found) if found else Detections.empty())


def _batches(units: Sequence[DetectUnit], size: int) -> Iterator[_Batch]:
    for unit in units:
        for start in range(0, len(unit.images), size):
            yield _Batch(unit, unit.images[start : start + size], start + size >= len(unit.images))


def _detect_batch(detector: Detector, batch: _Batch) -> _BatchResult:
    read: list[tuple[int, ImageFile]] = []
    images: list[np.ndarray[tuple[int, ...], np.dtype[np.uint8]]] = []
    warnings: list[str] = []
    for frame_index, file in batch.images:
        try:
            images.append(read_image(file, camera=batch.unit.camera))
            read.append((frame_index, file))
        except DriveFileError as error:
            warnings.append(str(error))
    start = time.perf_counter()
    found = detector.detect(images) if images else []
    seconds = time.perf_counter() - start
    frames = [(index, file.timestamp_ns, detections) for (index, file), detections in zip(read, found, strict=True)]
    return _BatchResult(frames, warnings, seconds)


def _write_clip(path: Path, results: Sequence[_BatchResult], artifacts: Artifacts) -> None:
    frames = [frame for result in results for frame in result.frames]
    note = {
        "frames": [frame_index for frame_index, _, _ in frames],
        "detections": sum(len(detections) for _, _, detections in frames),
        "timestamps_ns": [timestamp_ns for _, timestamp_ns, _ in frames],
        "warnings": [warning for result in results for warning in result.warnings],
    }
    parts = [
        columns_of(detections, frame_index=np.full(len(detections), frame_index, np.int32))
        for frame_index, _, detections in frames
    ] or [columns_of(Detections.empty(), frame_index=np.zeros(0, np.int32))]
    artifacts.make(path, lambda temporary: write_table(temporary, [concatenate(parts)], note=note))
