"""YOLOX on onnxruntime: images in, boxes of road users out.

For each image: plan how it goes into the network (one letterbox, or tiles), fill the input, run, decode the cells that
score enough, suppress duplicates. Images that need the same input shape share a run where the model takes a batch.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from labeler.detection.classes import suppression_group_of
from labeler.detection.config import DetectionConfig
from labeler.detection.decode import STRIDES_PX, anchor_grid, find_candidates
from labeler.detection.errors import DetectionError
from labeler.detection.letterbox import Letterbox, fit_letterbox
from labeler.detection.model import YoloxModel
from labeler.detection.suppression import suppress
from labeler.detection.tiles import Tile, join_tiles, plan_tiles
from labeler.detection.types import Detections
from labeler.inference import CPU_PROVIDER

_GPU_BATCH_SIZE = 8


@dataclass(frozen=True)
class _View:
    """A part of one of the images, on its way through the network."""

    image_index: int
    tile_index: int
    tile: Tile
    letterbox: Letterbox


class YoloxDetector:
    """Finds road users with any official YOLOX export. ``detect`` may be called from several threads at once."""

    def __init__(self, model: YoloxModel, config: DetectionConfig) -> None:
        """Raises DetectionError when the model knows none of the classes of ``config``."""
        self._model = model
        self._config = config
        known = model.layout.class_names
        self._class_names = tuple(name for name in dict.fromkeys(config.classes) if name in known)
        if not self._class_names:
            raise DetectionError(
                f"{model.path} knows none of the classes asked for ({', '.join(config.classes)}). It knows: "
                f"{', '.join(known)}."
            )
        self._kept_class = np.full(len(known), -1, np.int16)
        for kept, name in enumerate(self._class_names):
            self._kept_class[known.index(name)] = kept
        self._group_of_class = suppression_group_of(self._class_names)
        self._non_finite_count = 0
        self._count_lock = threading.Lock()

    @property
    def class_names(self) -> tuple[str, ...]:
        """The classes of the configuration that the model knows: what ``class_id`` counts in."""
        return self._class_names

    @property
    def providers(self) -> tuple[str, ...]:
        """The onnxruntime providers in use, the one that does most of the work first."""
        return self._model.providers

    @property
    def batch_size(self) -> int:
        """How many images ``detect`` takes best in one call: a fixed batch, or the configured one; 1 on the CPU, where
        a larger one gains nothing."""
        if self._model.layout.batch is not None:
            return self._model.layout.batch
        if self._config.batch_size is not None:
            return self._config.batch_size
        return 1 if self.providers[0] == CPU_PROVIDER else _GPU_BATCH_SIZE

    @property
    def non_finite_count(self) -> int:
        """How many boxes were dropped so far because the model gave NaN or infinity for them."""
        return self._non_finite_count

    def input_shapes(self, image_hw: tuple[int, int]) -> tuple[tuple[int, int], ...]:
        """Height and width of each network input that an image of this size becomes: one, or one per tile."""
        return tuple(view.letterbox.input_hw for view in self._plan(0, image_hw))

    def detect(self, images: Sequence[NDArray[np.uint8]]) -> list[Detections]:
        """One Detections for each (H, W, 3) uint8 image in BGR order; the images may differ in size.

        Raises ValueError for anything that is not such an image, DetectionError when the model fails."""
        views_by_shape: dict[tuple[int, int], list[_View]] = {}
        found: list[list[Detections]] = []
        for index, image in enumerate(images):
            _require_image(index, image)
            views = self._plan(index, (image.shape[0], image.shape[1]))
            found.append([Detections.empty()] * len(views))
            for view in views:
                views_by_shape.setdefault(view.letterbox.input_hw, []).append(view)
        for input_hw, views in views_by_shape.items():
            for first in range(0, len(views), self.batch_size):
                batch = views[first : first + self.batch_size]
                output = self._model.run(self._fill_input(images, batch, input_hw))
                for view, rows in zip(batch, output, strict=False):  # a fixed batch may be longer
                    found[view.image_index][view.tile_index] = self._boxes_of(view, rows)
        return [
            parts[0] if len(parts) == 1 else self._join(parts, (image.shape[0], image.shape[1]))
            for parts, image in zip(found, images, strict=True)
        ]

    def _plan(self, image_index: int, image_hw: tuple[int, int]) -> list[_View]:
        return [
            _View(image_index, tile_index, tile, letterbox)
            for tile_index, (tile, letterbox) in enumerate(self._letterboxes(image_hw))
        ]

    def _letterboxes(self, image_hw: tuple[int, int]) -> Iterator[tuple[Tile, Letterbox]]:
        layout, long_side_px = self._model.layout, self._config.input_long_side_px
        for tile in self._tiles(image_hw):
            yield (
                tile,
                fit_letterbox(tile.hw, height=layout.height, width=layout.width, long_side_px=long_side_px),
            )

    def _tiles(self, image_hw: tuple[int, int]) -> tuple[Tile, ...]:
        height, width = self._model.layout.height, self._model.layout.width
        if height is None or width is None:
            return (Tile(0, 0, image_hw[1], image_hw[0]),)
        return plan_tiles(
            image_hw, (height, width), aspect_limit=self._config.tile_aspect, overlap=self._config.tile_overlap
        )

    def _fill_input(
        self, images: Sequence[NDArray[np.uint8]], views: Sequence[_View], input_hw: tuple[int, int]
    ) -> NDArray[np.float32]:
        count = self._model.layout.batch or len(views)
        blob = np.empty((count, 3, *input_hw), np.float32)
        for planes, view in zip(blob, views, strict=False):
            view.letterbox.write(view.tile.cut(images[view.image_index]), planes)
        blob[len(views) :] = 0
        return blob

    def _boxes_of(self, view: _View, rows: NDArray[np.float32]) -> Detections:
        """One view's output rows (A, 5 + C) to boxes in pixels of the whole image."""
        candidates = find_candidates(
            rows,
            anchor_grid(view.letterbox.input_hw),
            decoded=self._model.layout.decoded,
            min_score=self._config.min_score,
            wanted=self._kept_class >= 0,
        )
        if candidates.non_finite:
            with self._count_lock:
                self._non_finite_count += candidates.non_finite
        tile = view.tile
        xyxy_px = view.letterbox.to_image(candidates.xyxy_px)
        xyxy_px += np.array([tile.x1, tile.y1, tile.x1, tile.y1], np.float32)
        np.clip(xyxy_px[:, 0::2], tile.x1, tile.x2, out=xyxy_px[:, 0::2])
        np.clip(xyxy_px[:, 1::2], tile.y1, tile.y2, out=xyxy_px[:, 1::2])
        boxes = Detections(xyxy_px, candidates.score, self._kept_class[candidates.model_class])
        has_area = np.all(xyxy_px[:, 2:] > xyxy_px[:, :2], axis=1)
        return self._suppress(boxes[has_area])

    def _join(self, parts: list[Detections], image_hw: tuple[int, int]) -> Detections:
        letterboxes = list(self._letterboxes(image_hw))
        reach_px = float(STRIDES_PX[0] / letterboxes[0][1].input_per_image.min())
        tiles = tuple(tile for tile, _ in letterboxes)
        return self._suppress(join_tiles(tiles, parts, self._group_of_class, reach_px=reach_px))

    def _suppress(self, boxes: Detections) -> Detections:
        return boxes[
            suppress(
                boxes.xyxy_px,
                boxes.score,
                self._group_of_class[boxes.class_id],
                iou=self._config.nms_iou,
                max_candidates=self._config.max_candidates,
            )
        ]


def open_detector(
    path: Path | str,
    config: DetectionConfig | None = None,
    *,
    providers: Sequence[str] | None = None,
    intra_op_threads: int = 1,
) -> YoloxDetector:
    """A detector from an .onnx file; ``config`` None is the default one.

    ``providers`` are onnxruntime's names, best first; None takes a GPU where onnxruntime offers one, else the CPU.
    ``intra_op_threads`` is how many cores one run on the CPU uses. The default of 1 suits a caller that detects from
    one thread per core, which is quickest on small networks; 0 gives each run all cores. Raises DetectionError when the
    file is missing, is no YOLOX model, or knows none of the classes asked for.
    """
    model = YoloxModel(path, providers=providers, intra_op_threads=intra_op_threads)
    return YoloxDetector(model, DetectionConfig() if config is None else config)


def _require_image(index: int, image: NDArray[np.uint8]) -> None:
    if image.ndim != 3 or image.shape[2] != 3 or image.dtype != np.uint8 or image.size == 0:
        raise ValueError(
            f"images[{index}] must be (H, W, 3) uint8 with at least one pixel, got {image.shape} {image.dtype}"
        )
