"""Recorded detections and truth as text, in the layout of the KITTI tracking benchmark: measuring without images.

    <root>/label_02/<sequence>.txt     truth: frame, id, type, ... as in the benchmark's development kit
           calib/<sequence>.txt        calibration, for distances
           det_*/<sequence>.txt        detections of cars, a row each: frame, x1, y1, x2, y2, score

Frames are a tenth of a second apart. Cars count. Vans, cars beyond the largest distance and DontCare regions are
neither hit nor miss and absorb boxes that fall on them, as in the benchmark's own evaluation; a box on any other
vehicle is false.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from labeler.detection.types import Detections
from labeler.drive.kitti import PERIOD_NS
from labeler.drive.kitti_text import read_calibration, read_truth_labels
from labeler.drive.types import Truth, TruthBoxes2D
from labeler.evaluation.sequences import DetectedSequence
from labeler.evaluation.truth import TruthTable, prepare_truth
from labeler.evaluation.types import EvaluationConfig, EvaluationError
from labeler.tracking import DetectedFrame

CAMERA = "image_02"
CAR_CLASS_ID = 0

_DETECTION_FIELDS = 6
_LARGEST_FRAME = 1_000_000
_COUNTED = "Car"
_ABSORBING = ("Van", "DontCare")


def read_sequences(
    root: Path, *, detections: str | None = None, config: EvaluationConfig
) -> Iterator[DetectedSequence]:
    """The sequences of a folder in order of their names, one in memory at a time: of each every frame from 0 to the
    last that truth or detections name.

    ``detections`` names the folder of detections; without it, it is the only ``det_*`` with rows of six fields.
    EvaluationError where files are missing or malformed: the message names the file and the line.
    """
    folder = _detection_folder(root, detections)
    names = sorted(path.stem for path in (root / "label_02").glob("*.txt"))
    if not names:
        raise EvaluationError(f"{root} has no truth: label_02/<sequence>.txt is looked for.")
    for name in names:
        for needed in (folder / f"{name}.txt", root / "calib" / f"{name}.txt"):
            if not needed.is_file():
                raise EvaluationError(f"{needed} is missing, but label_02 has a sequence {name}.")
        yield _read_sequence(root, folder, name, config)


def _detection_folder(root: Path, name: str | None) -> Path:
    if name is not None:
        if not (root / name).is_dir():
            raise EvaluationError(f"{root} has no folder {name} of detections.")
        return root / name
    folders = [path for path in sorted(root.glob("det_*")) if path.is_dir() and _has_plain_rows(path)]
    if len(folders) != 1:
        found = ", ".join(path.name for path in folders) or "none"
        raise EvaluationError(
            f"{root} needs one folder det_* whose files have rows of frame, x1, y1, x2, y2, score; it has {found}. "
            "Name the folder to use."
        )
    return folders[0]


def _has_plain_rows(folder: Path) -> bool:
    for path in sorted(folder.glob("*.txt")):
        lines = _lines(path)
        if lines:
            return len(lines[0].split(",")) == _DETECTION_FIELDS
    return False


def _read_sequence(root: Path, folder: Path, name: str, config: EvaluationConfig) -> DetectedSequence:
    table = _read_detections(folder / f"{name}.txt")
    labels = root / "label_02" / f"{name}.txt"
    count = max(int(table[:, 0].max(initial=-1)), _last_frame(labels)) + 1
    calibration = read_calibration(root / "calib" / f"{name}.txt")
    truth = read_truth_labels(labels, {frame: frame for frame in range(count)}, calibration, camera=CAMERA)
    if truth.boxes_2d is None:
        raise EvaluationError(f"{labels} has no boxes.")
    groups = (0,) * (CAR_CLASS_ID + 1)
    return DetectedSequence(name, _frames(table, count), _truth_of_cars(truth.boxes_2d, config), ("car",), groups)


def _truth_of_cars(boxes: TruthBoxes2D, config: EvaluationConfig) -> TruthTable:
    """Cars count, what absorbs does not, and the rest is left out."""
    kept = np.flatnonzero([category == _COUNTED or category in _ABSORBING for category in boxes.category]).tolist()
    category = tuple(boxes.category[row] for row in kept)
    taking_part = TruthBoxes2D(
        frame_index=boxes.frame_index[kept],
        camera=(CAMERA,) * len(kept),
        track_uuid=tuple(boxes.track_uuid[row] for row in kept),
        category=tuple(name if name == _COUNTED else "DontCare" for name in category),
        xyxy_px=boxes.xyxy_px[kept],
        distance_m=None if boxes.distance_m is None else boxes.distance_m[kept],
    )
    prepared = prepare_truth(Truth(taking_part, None), (CAMERA,), config)
    assert prepared is not None
    return prepared


def _frames(table: NDArray[np.float64], count: int) -> tuple[DetectedFrame, ...]:
    order = np.lexsort((-table[:, 5], table[:, 0]))
    table = table[order]
    starts = np.searchsorted(table[:, 0], np.arange(count + 1))
    frames: list[DetectedFrame] = []
    for index in range(count):
        rows = table[starts[index] : starts[index + 1]].astype(np.float32)
        cars = Detections(rows[:, 1:5], rows[:, 5], np.full(len(rows), CAR_CLASS_ID, np.int16))
        frames.append(DetectedFrame(index, index * PERIOD_NS, cars))
    return tuple(frames)


def _read_detections(path: Path) -> NDArray[np.float64]:
    """(N, 6) rows of frame, box and score."""
    rows: list[list[float]] = []
    for number, line in enumerate(_lines(path), 1):
        if not line.strip():
            continue
        try:
            row = [float(text) for text in line.split(",")]
        except ValueError as error:
            raise EvaluationError(f"{path}: line {number} holds something that is no number: {error}.") from error
        if len(row) != _DETECTION_FIELDS:
            raise EvaluationError(f"{path}: line {number} has {len(row)} fields, but frame, box and score are 6.")
        if not (0 <= row[0] <= _LARGEST_FRAME and row[0] == int(row[0])):
            raise EvaluationError(f"{path}: line {number} must begin with a frame number, not {row[0]:g}.")
        rows.append(row)
    return np.array(rows, np.float64).reshape(-1, _DETECTION_FIELDS)


def _last_frame(path: Path) -> int:
    last = -1
    for number, line in enumerate(_lines(path), 1):
        if fields := line.split():
            try:
                frame = int(fields[0])
            except ValueError as error:
                raise EvaluationError(f"{path}: line {number} must begin with a frame number.") from error
            if not 0 <= frame <= _LARGEST_FRAME:
                raise EvaluationError(f"{path}: line {number} begins with {frame}, which can be no frame number.")
            last = max(last, frame)
    return last


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is no text"
        raise EvaluationError(f"{path} can't be read: {reason}.") from error
