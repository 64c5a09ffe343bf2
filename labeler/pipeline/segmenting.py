"""Segmentation over a drive: images in, one file of scores for each camera and clip of frames.

Only what painting reads is segmented: images of calibrated cameras in drives with LiDAR. The file is a compressed table
with a batch for each image, whose rows are the planes of the classes, so a reader takes one image at a time.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from labeler.drive import Camera, DriveFileError, ImageFile, read_image
from labeler.pipeline.artifacts import Artifacts
from labeler.pipeline.tables import read_batch, read_note, write_table
from labeler.pipeline.threads import in_threads
from labeler.pipeline.types import Progress
from labeler.segmentation import SegmentationScores, Segmenter

STAGE = "segment"
VERSION = 1


@dataclass(frozen=True)
class SegmentUnit:
    """A clip of one camera: its number, its images with their frames, and a key of what the scores depend on."""

    key: str
    camera: Camera
    clip: int
    images: tuple[tuple[int, ImageFile], ...]


@dataclass(frozen=True)
class _Item:
    unit: SegmentUnit
    frame_index: int
    file: ImageFile
    is_last: bool


@dataclass(frozen=True)
class _Result:
    """``scores`` is None where the image could not be read, which ``warning`` then says."""

    frame_index: int
    scores: SegmentationScores | None
    warning: str | None


def segment(
    units: Sequence[SegmentUnit], segmenter: Segmenter, *, artifacts: Artifacts, threads: int, progress: Progress
) -> list[Path]:
    """Segment in every unit that has no artifact yet; the artifacts of all units, in their order.

    An image that can't be read is skipped and noted."""
    paths = [artifacts.path(STAGE, f"{unit.key}-{VERSION}", "arrow") for unit in units]
    left = [(unit, path) for unit, path in zip(units, paths, strict=True) if not path.exists()]
    progress.stage(STAGE, sum(len(unit.images) for unit, _ in left))
    path_of = {unit.key: path for unit, path in left}
    done: list[_Result] = []
    items = _items([unit for unit, _ in left])
    for item, result in in_threads(partial(_segment_image, segmenter), items, threads=threads, name=STAGE):
        done.append(result)
        if item.is_last:
            write = partial(_write_clip, class_names=segmenter.class_names, results=done)
            artifacts.make(path_of[item.unit.key], write)
            done = []
        progress.advance()
    return paths


class SegmentationClip:
    """The scores of one camera's clip, read from its artifact one image at a time."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._note = read_note(path)
        self._batch_of_frame = {frame: number for number, frame in enumerate(self._note["frames"])}

    def at(self, frame_index: int) -> SegmentationScores | None:
        """The scores of the clip's image at that frame; None where it has none, or one that could not be read."""
        number = self._batch_of_frame.get(frame_index)
        if number is None:
            return None
        planes = read_batch(self._path, number)["plane"]
        width_px, height_px = self._note["size_px"]
        return SegmentationScores(
            tuple(self._note["class_names"]),
            planes.reshape(len(planes), self._note["rows"], -1),
            stride_px=self._note["stride_px"],
            size_px=(width_px, height_px),
        )


def _items(units: Sequence[SegmentUnit]) -> Iterator[_Item]:
    for unit in units:
        for number, (frame_index, file) in enumerate(unit.images, start=1):
            yield _Item(unit, frame_index, file, number == len(unit.images))


def _segment_image(segmenter: Segmenter, item: _Item) -> _Result:
    try:
        image = read_image(item.file, camera=item.unit.camera)
    except DriveFileError as error:
        return _Result(item.frame_index, None, str(error))
    return _Result(item.frame_index, segmenter.segment(image), None)


def _write_clip(path: Path, *, class_names: tuple[str, ...], results: Sequence[_Result]) -> None:
    """All images of a camera have one size, so one note serves all of them."""
    found = [(result.frame_index, result.scores) for result in results if result.scores is not None]
    note: dict[str, object] = {
        "class_names": class_names,
        "frames": [frame_index for frame_index, _ in found],
        "warnings": [result.warning for result in results if result.warning is not None],
    }
    if not found:
        write_table(path, [{"plane": np.zeros((0, 1), np.uint8)}], note=note)
        return
    first = found[0][1]
    note |= {"rows": first.scores.shape[1], "stride_px": first.stride_px, "size_px": first.size_px}
    planes = ({"plane": scores.scores.reshape(len(class_names), -1)} for _, scores in found)
    write_table(path, planes, note=note, compressed=True)
