"""Cuts training examples out of images: a window of changing size and place, flipped and recoloured at random.

A window of a quarter of the image costs a quarter of the time, and the networks have no fixed size, so they learn on
windows and run on whole images. Half of the windows are laid around an object, rare classes more often than they come.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from labeler.detection.letterbox import PAD_VALUE
from labeler.training.pictures import MIN_SIDE_PX, Picture


@dataclass(frozen=True)
class CropConfig:
    """``height_px`` by ``width_px`` examples, whose source is shown at ``smallest_scale`` to ``largest_scale`` times
    its size. ``around_objects`` of them are laid around one. A box that a window cuts is asked for when at least
    ``kept_share`` of it is inside, else ignored. With ``replicate_edge`` what lies beyond the image repeats its edge,
    else it is the detector's grey."""

    height_px: int
    width_px: int
    smallest_scale: float = 0.5
    largest_scale: float = 1.4
    around_objects: float = 0.5
    kept_share: float = 0.4
    beyond_px: int = 24
    replicate_edge: bool = False


@dataclass(frozen=True, eq=False)
class _Window:
    """A part of an image, in its pixels: x, y of the upper left corner, and how many example pixels one becomes."""

    x: float
    y: float
    scale: float


class CropSampler:
    """Draws examples from pictures. Holds no random state: the same generator gives the same examples."""

    def __init__(self, pictures: Sequence[Picture], config: CropConfig) -> None:
        self._pictures, self._config = pictures, config
        objects = [(index, row) for index, picture in enumerate(pictures) for row in range(len(picture.boxes_px))]
        classes = np.array([pictures[index].classes[row] for index, row in objects], np.int64)
        self._objects = objects
        self._by_class: list[NDArray[np.intp]] = [
            np.flatnonzero(classes == class_id) for class_id in np.unique(classes)
        ]
        # The root of the frequency: between as often as they come and equally often.
        weights: NDArray[np.float64] = np.array([len(rows) ** 0.5 for rows in self._by_class], np.float64)
        self._class_weights = weights / weights.sum() if len(weights) else weights

    def draw(self, rng: np.random.Generator) -> Picture:
        """One example, of the configured size."""
        config = self._config
        scale = math.exp(rng.uniform(math.log(config.smallest_scale), math.log(config.largest_scale)))
        size = np.array([config.width_px, config.height_px]) / scale
        if self._objects and rng.random() < config.around_objects:
            rows = self._by_class[rng.choice(len(self._by_class), p=self._class_weights)]
            index, row = self._objects[int(rng.choice(rows))]
            picture = self._pictures[index]
            box = picture.boxes_px[row]
            corner = (box[:2] + box[2:]) / 2 - size * rng.uniform(0.1, 0.9, 2)
        else:
            picture = self._pictures[int(rng.integers(len(self._pictures)))]
            corner = rng.uniform(0, 1, 2) * (np.array(picture.image.shape[1::-1]) - size)
        room = np.array(picture.image.shape[1::-1]) - size + config.beyond_px
        corner = np.clip(corner, 0, np.maximum(room, 0))
        cut = _cut(picture, _Window(float(corner[0]), float(corner[1]), scale), config)
        return _recolored(_flipped(cut) if rng.random() < 0.5 else cut, rng)


def _cut(picture: Picture, window: _Window, config: CropConfig) -> Picture:
    size = (config.width_px, config.height_px)
    matrix = np.array([[1, 0, -window.x], [0, 1, -window.y]]) * window.scale
    matrix[:, 2] += (window.scale - 1) / 2  # pixel centres are at half
    border = cv2.BORDER_REPLICATE if config.replicate_edge else cv2.BORDER_CONSTANT
    source = picture.image
    if window.scale < 1:  # what is shrunk is blurred first, or its pixels would be picked at random
        source = cv2.blur(source, (2, 2), anchor=(0, 0)) if window.scale < 0.7 else source
    image = cv2.warpAffine(
        source, matrix, size, flags=cv2.INTER_LINEAR, borderMode=border, borderValue=(PAD_VALUE,) * 3
    )
    semantic = picture.semantic
    if semantic is not None:
        semantic = np.asarray(
            cv2.warpAffine(semantic, matrix, size, flags=cv2.INTER_NEAREST, borderMode=cv2.BORDER_REPLICATE), np.uint8
        )
    offset = np.array([window.x, window.y] * 2, np.float32)
    limit = np.array(size * 2, np.float32)
    boxes = (picture.boxes_px - offset) * np.float32(window.scale)
    ignored = np.clip((picture.ignored_px - offset) * np.float32(window.scale), 0, limit)
    clipped = np.clip(boxes, 0, limit)
    sides = clipped[:, 2:] - clipped[:, :2]
    inside = sides.prod(axis=1) / (boxes[:, 2:] - boxes[:, :2]).prod(axis=1)
    shown = (sides > 0).all(axis=1)
    asked = shown & (inside >= config.kept_share) & (sides >= MIN_SIDE_PX).all(axis=1)
    ignored = np.concatenate([ignored[(ignored[:, 2:] > ignored[:, :2]).all(axis=1)], clipped[shown & ~asked]])
    return Picture(np.asarray(image, np.uint8), clipped[asked], picture.classes[asked], ignored, semantic)


def _flipped(picture: Picture) -> Picture:
    width = picture.image.shape[1]

    def mirrored(boxes_px: NDArray[np.float32]) -> NDArray[np.float32]:
        return np.stack([width - boxes_px[:, 2], boxes_px[:, 1], width - boxes_px[:, 0], boxes_px[:, 3]], axis=1)

    return Picture(
        np.asarray(cv2.flip(picture.image, 1), np.uint8),
        mirrored(picture.boxes_px),
        picture.classes,
        mirrored(picture.ignored_px),
        None if picture.semantic is None else picture.semantic[:, ::-1],
    )


def _recolored(picture: Picture, rng: np.random.Generator) -> Picture:
    """Another exposure, contrast and tint, as of another camera."""
    gain = rng.uniform(0.75, 1.25) * rng.uniform(0.93, 1.07, 3)
    gamma = np.exp(rng.uniform(-0.25, 0.25))
    levels = (np.arange(256) / 255.0) ** gamma
    table = np.clip(levels[:, None] * gain * 255.0, 0, 255).astype(np.uint8)
    image = np.asarray(cv2.LUT(np.ascontiguousarray(picture.image), table[:, None, :]), np.uint8)
    return Picture(image, picture.boxes_px, picture.classes, picture.ignored_px, picture.semantic)
