"""Simulated drives as training wants them: all images in memory, with the truth that can be asked for.

A detector learns the *visible* boxes: that is what detectors of real roads are trained on, what can be seen in an
image, and what the painting of LiDAR points needs (points inside the box that belong to something else mislead it).
Objects of which too little shows are ignored, which is neither an object nor background.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import cv2
import numpy as np
from numpy.typing import NDArray

from labeler.drive.errors import DriveError
from labeler.drive.images import read_image
from labeler.drive.registry import open_drive
from labeler.drive.types import Drive, ImageFile, TruthBoxes2D
from labeler.evaluation.categories import CLASSES as COUNTED_CLASSES
from labeler.evaluation.categories import class_of_category
from labeler.simulation.materials import Semantic
from labeler.training.errors import TrainingError

DETECTOR_CLASSES = ("car", "truck", "bus", "motorcycle")
SEGMENTATION_CLASSES = tuple(kind.name.lower() for kind in Semantic)
MIN_VISIBLE_PIXELS = 30
MIN_VISIBLE_SHARE = 0.1
MIN_SIDE_PX = 4.0


@dataclass(frozen=True, eq=False)
class Picture:
    """One image: ``image`` (H, W, 3) uint8 BGR; ``boxes_px`` (G, 4) float32 visible boxes and ``classes`` (G,) int64 of
    what is asked for; ``ignored_px`` (I, 4) float32 boxes where nothing is asked; ``semantic`` (H, W) uint8, a
    ``Semantic`` a pixel, None where the drive has none."""

    image: NDArray[np.uint8]
    boxes_px: NDArray[np.float32]
    classes: NDArray[np.int64]
    ignored_px: NDArray[np.float32]
    semantic: NDArray[np.uint8] | None


def find_drives(folders: Sequence[Path]) -> list[Path]:
    """The drives named by ``folders``, each a drive or a folder of drives, by name. TrainingError when there are
    none."""
    found: list[Path] = []
    for folder in folders:
        if (folder / "sensors").is_dir():
            found.append(folder)
        elif folder.is_dir():
            found += sorted((child for child in folder.iterdir() if (child / "sensors").is_dir()), key=_by_number)
    if not found:
        named = ", ".join(str(folder) for folder in folders)
        raise TrainingError(f"There is no drive in {named}. Make some: hindsight train drives FOLDER")
    return found


def _by_number(folder: Path) -> tuple[str, int]:
    """train2 before train10."""
    letters = folder.name.rstrip("0123456789")
    return letters, int(folder.name[len(letters) :] or -1)


def load_pictures(drives: Sequence[Path]) -> list[Picture]:
    """All images of the drives. TrainingError when a drive can't be opened or has no true boxes."""
    pictures: list[Picture] = []
    for folder in drives:
        pictures += pictures_of(opened(folder))
    return pictures


def pictures_of(drive: Drive) -> Iterator[Picture]:
    """The images of a drive, in order of frames and cameras. TrainingError when it has no true boxes in images."""
    truth = drive.read_truth(drive.frames)
    if truth is None or truth.boxes_2d is None or truth.boxes_2d.visible_xyxy_px is None:
        raise TrainingError(f"{drive.root} has no visible true boxes (annotations_2d.feather) to learn from.")
    boxes = truth.boxes_2d
    rows_of: dict[tuple[int, str], list[int]] = {}
    for row, (frame, camera) in enumerate(zip(boxes.frame_index.tolist(), boxes.camera, strict=True)):
        rows_of.setdefault((frame, camera), []).append(row)
    for frame in drive.frames:
        for name, file in frame.images.items():
            rows = np.array(rows_of.get((frame.index, name), []), np.intp)
            yield _picture(drive, file, boxes, rows)


def opened(folder: Path) -> Drive:
    """Open a drive. TrainingError when that fails."""
    try:
        return open_drive(folder)
    except DriveError as error:
        raise TrainingError(f"{folder} can't be learned from: {error}") from error


def _picture(drive: Drive, file: ImageFile, boxes: TruthBoxes2D, rows: NDArray[np.intp]) -> Picture:
    image = read_image(file, drive.camera(file.camera))
    assert boxes.visible_xyxy_px is not None
    visible_px = boxes.visible_xyxy_px[rows]
    names = [class_of_category(boxes.category[row]) for row in map(int, rows)]
    classes = np.array([_class_id(counted) for counted in names], np.int64)
    asked = (classes >= 0) & ((visible_px[:, 2:] - visible_px[:, :2]).min(axis=1, initial=np.inf) >= MIN_SIDE_PX)
    if boxes.visible_pixels is not None:
        asked &= boxes.visible_pixels[rows] >= MIN_VISIBLE_PIXELS
    if boxes.visible_share is not None:
        asked &= boxes.visible_share[rows] >= MIN_VISIBLE_SHARE
    semantic = _read_semantic(drive.root / "semantic" / file.camera / f"{file.timestamp_ns}.png", image.shape[:2])
    return Picture(image, visible_px[asked], classes[asked], visible_px[~asked], semantic)


def _class_id(counted: int) -> int:
    """Index into DETECTOR_CLASSES of a class of evaluation; -1 for what the detector does not learn."""
    return DETECTOR_CLASSES.index(COUNTED_CLASSES[counted]) if 0 <= counted < len(DETECTOR_CLASSES) else -1


def _read_semantic(path: Path, shape: tuple[int, ...]) -> NDArray[np.uint8] | None:
    if not path.exists():
        return None
    semantic = cast("NDArray[np.uint8] | None", cv2.imread(str(path), cv2.IMREAD_UNCHANGED))
    if semantic is None or semantic.shape != shape:
        raise TrainingError(f"{path} is not an image of classes of the size of its camera's. Make the drive again.")
    return semantic
