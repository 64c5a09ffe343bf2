"""What the pipeline costs beside the least that any program must do: decode every image and run the model on it.

Both are timed in turn in one process, so that a machine whose speed drifts slows both. The bare loop is what a short
script would be: read, shrink to the model's input, run, one image after the other, with onnxruntime's own defaults (all
cores in each run). It starts with the model loaded; the pipeline's time includes loading it, hashing the files, every
stage, and writing the artifacts.
"""

from __future__ import annotations

import statistics
import tempfile
import time
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TypedDict

import cv2
import numpy as np

from labeler.detection import YoloxDetector, open_detector
from labeler.drive import Drive, Frame, ImageFile
from labeler.inference import open_session
from labeler.pipeline.run import label_drive
from labeler.pipeline.settings import LabelSettings

_ALL_CORES = 0


class PipelineTimes(TypedDict):
    """Medians over the runs, in seconds.

    ``ratio`` is the median of (pipeline - LiDAR) / bare, run by run. ``peak_memory_mb`` is the largest sum of resident
    memory of the process and its workers in the first run of the pipeline, before the bare loop has loaded a model.
    """

    frames: int
    bare_seconds: float
    pipeline_seconds: float
    lidar_seconds: float
    ratio: float
    peak_memory_mb: float


def benchmark_pipeline(
    drive: Drive, *, model: Path, settings: LabelSettings | None = None, runs: int = 3
) -> PipelineTimes:
    """Time the pipeline and the bare loop on ``drive``, ``runs`` times in turn, each time from an empty workspace.

    Raises DetectionError for a model that can't be used.
    """
    settings = settings or LabelSettings()
    bare: list[float] = []
    pipeline: list[float] = []
    lidar: list[float] = []
    peak_memory_mb = 0.0
    for run in range(runs):
        with tempfile.TemporaryDirectory(prefix="hindsight-benchmark-") as workspace:
            start = time.perf_counter()
            labelled = label_drive(drive, model=model, workspace=Path(workspace), settings=settings)
            pipeline.append(time.perf_counter() - start)
        lidar.append(labelled.summary["seconds"]["lidar"])
        if run == 0:
            peak_memory_mb = labelled.summary["peak_memory_mb"]
        bare.append(_run_bare(drive, model, open_detector(model, settings.detection)))
    ratios = [(whole - points) / least for whole, points, least in zip(pipeline, lidar, bare, strict=True)]
    return PipelineTimes(
        frames=len(drive.frames),
        bare_seconds=round(statistics.median(bare), 3),
        pipeline_seconds=round(statistics.median(pipeline), 3),
        lidar_seconds=round(statistics.median(lidar), 3),
        ratio=round(statistics.median(ratios), 3),
        peak_memory_mb=peak_memory_mb,
    )


def repeat_frames(drive: Drive, times: int) -> Drive:
    """The drive with its frames ``times`` over, one after the other in time; every copy reads the same files."""
    first, last = drive.frames[0].timestamp_ns, drive.frames[-1].timestamp_ns
    period_ns = (last - first) // max(1, len(drive.frames) - 1) or 100_000_000
    span_ns = last - first + period_ns
    frames = [
        _shifted(frame, len(drive.frames) * copy, span_ns * copy) for copy in range(times) for frame in drive.frames
    ]
    return replace(drive, frames=tuple(frames))


def _shifted(frame: Frame, by_index: int, by_ns: int) -> Frame:
    images = {
        camera: ImageFile(file.camera, file.timestamp_ns + by_ns, file.path) for camera, file in frame.images.items()
    }
    sweep = frame.sweep and replace(frame.sweep, timestamp_ns=frame.sweep.timestamp_ns + by_ns)
    return Frame(frame.index + by_index, frame.timestamp_ns + by_ns, images, sweep)


def _run_bare(drive: Drive, model: Path, detector: YoloxDetector) -> float:
    """Seconds for decoding every image and running the model on it. The detector only tells the input shapes."""
    session = open_session(model, providers=detector.providers, intra_op_threads=_ALL_CORES)
    name = session.inputs[0].name
    start = time.perf_counter()
    for path in _image_paths(drive):
        image = cv2.imread(str(path))
        if image is None:
            continue
        for height, width in detector.input_shapes((image.shape[0], image.shape[1])):
            blob = cv2.dnn.blobFromImage(image, size=(width, height))
            session.run({name: np.asarray(blob, np.float32)})
    return time.perf_counter() - start


def _image_paths(drive: Drive) -> Iterable[Path]:
    return (file.path for frame in drive.frames for file in frame.images.values())
