"""Semantic segmentation on onnxruntime: images in, scores of every class out.

For each image: shrink it where it is larger than the network wants, fill the input's rest with the image's last row and
column, run, softmax where the network gives logits, and keep the scores as whole numbers 0..255 on the network's own
grid. A network that answers pixel by pixel is averaged to cells of 4 pixels: painting LiDAR points needs no more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from labeler.segmentation.model import SegmentationLayout, SegmentationModel
from labeler.segmentation.types import SegmentationScores

_FINEST_STRIDE_PX = 4
_CERTAIN = 255
_STEP = 17
"""Scores are kept in sixteen levels, 0, 17, ... 255: a third of the disk space of all 256, and fine enough to paint."""


@dataclass(frozen=True)
class Placement:
    """How an image lies in a network's input of ``input_hw``: shrunk by ``scale``, as its upper left ``placed_hw``."""

    input_hw: tuple[int, int]
    placed_hw: tuple[int, int]
    scale: float


class Segmenter:
    """Segments images with any network of the form in :mod:`labeler.segmentation.model`. ``segment`` may be called from
    several threads at once."""

    def __init__(self, model: SegmentationModel) -> None:
        self._model = model

    @property
    def class_names(self) -> tuple[str, ...]:
        """The classes of the model, in the order of the scores' planes."""
        return self._model.layout.class_names

    @property
    def providers(self) -> tuple[str, ...]:
        """The onnxruntime providers in use, the one that does most of the work first."""
        return self._model.providers

    def segment(self, image: NDArray[np.uint8]) -> SegmentationScores:
        """The scores of one (H, W, 3) uint8 image in BGR order.

        Raises ValueError for anything that is not such an image, SegmentationError when the model fails."""
        if image.ndim != 3 or image.shape[2] != 3 or image.dtype != np.uint8 or image.size == 0:
            raise ValueError(f"image must be (H, W, 3) uint8 with at least one pixel, got {image.shape} {image.dtype}")
        layout = self._model.layout
        height, width = image.shape[0], image.shape[1]
        placement = place((height, width), layout)
        output = self._model.run(_input_of(image, placement, layout))[0]
        scores = _softmax(output) if layout.logits else output
        joined = max(1, _FINEST_STRIDE_PX // layout.stride_px)
        cell_px = layout.stride_px * joined
        rows, columns = ceil(placement.placed_hw[0] / cell_px), ceil(placement.placed_hw[1] / cell_px)
        scores = _averaged(scores, joined)[:, :rows, :columns]  # the rest describes the filling
        return SegmentationScores(
            layout.class_names,
            (np.rint(np.clip(np.nan_to_num(scores), 0, 1) * (_CERTAIN / _STEP)) * _STEP).astype(np.uint8),
            stride_px=cell_px / placement.scale,
            size_px=(width, height),
        )


def open_segmenter(path: Path | str, *, providers: Sequence[str] | None = None, intra_op_threads: int = 1) -> Segmenter:
    """A segmenter from an .onnx file; ``providers`` and ``intra_op_threads`` as for a detector.

    Raises ModelError when the file is missing or is no segmentation model."""
    return Segmenter(SegmentationModel(path, providers=providers, intra_op_threads=intra_op_threads))


def place(image_hw: tuple[int, int], layout: SegmentationLayout) -> Placement:
    """Where an image goes: never enlarged where the input's size is free, scaled to fit where it is fixed."""
    sides = ((layout.height, image_hw[0]), (layout.width, image_hw[1]))
    limits = [side / own for side, own in sides if side is not None]
    if layout.height is None or layout.width is None:
        limits += [1.0, layout.long_side_px / max(image_hw)]
    scale = min(limits)
    # A grid that reached less far than the image would leave its last pixels without a score.
    height, width = (ceil(round(own * scale, 6)) for _, own in sides)
    multiple = layout.multiple_px
    input_hw = (layout.height or _up_to(height, multiple), layout.width or _up_to(width, multiple))
    return Placement(input_hw, (height, width), scale)


def _up_to(side_px: int, multiple_px: int) -> int:
    return -(-side_px // multiple_px) * multiple_px


def _input_of(image: NDArray[np.uint8], placement: Placement, layout: SegmentationLayout) -> NDArray[np.float32]:
    height, width = placement.placed_hw
    if (height, width) != image.shape[:2]:
        shrinks = cv2.INTER_AREA if placement.scale < 1 else cv2.INTER_LINEAR
        image = np.asarray(cv2.resize(image, (width, height), interpolation=shrinks), np.uint8)
    planes = cv2.split(image)
    blob = np.empty((layout.batch or 1, 3, *placement.input_hw), np.float32)
    for channel, plane in enumerate(reversed(planes) if layout.reversed_colours else planes):
        target = blob[0, channel]
        target[:height, :width] = plane
        target[:height, width:] = plane[:, -1:]
        target[height:] = target[height - 1]
        if layout.mean[channel] != 0 or layout.std[channel] != 1:
            target -= layout.mean[channel]
            target /= layout.std[channel]
    blob[1:] = blob[0]
    return blob


def _softmax(logits: NDArray[np.float32]) -> NDArray[np.float32]:
    """(C, h, w) probabilities over the classes; NaN in a cell where a logit is not finite."""
    with np.errstate(invalid="ignore"):
        power = np.exp(logits - logits.max(axis=0))
        return power / power.sum(axis=0)


def _averaged(scores: NDArray[np.float32], joined: int) -> NDArray[np.float32]:
    """Means over squares of ``joined`` cells; the last row and column are repeated where they don't fill a square."""
    if joined == 1:
        return scores
    classes, rows, columns = scores.shape
    padded = np.pad(scores, ((0, 0), (0, -rows % joined), (0, -columns % joined)), mode="edge")
    shape = (classes, padded.shape[1] // joined, joined, padded.shape[2] // joined, joined)
    return padded.reshape(shape).mean(axis=(2, 4))
