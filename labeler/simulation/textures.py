"""Pictures drawn from code, and the set of layers that the graphics card gets.

A ``Picture`` is drawn in metres: its user says which stretch of which axis it covers and then puts polygons and lines.
Beside the colour it holds, for each pixel, how metallic, rough and glassy the surface is.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

LAYER_PX = 512
_SUPERSAMPLING = 2
_SHIFT = 4  # bits behind the point in OpenCV's coordinates


@dataclass(frozen=True)
class Ink:
    """``rgb`` in sRGB, 0 to 255; ``paint`` from 0 (covers) to 1 (takes the vehicle's paint)."""

    rgb: tuple[float, float, float]
    paint: float = 0.0
    metal: float = 0.0
    rough: float = 0.5
    glass: float = 0.0


WINDOW = Ink((14, 17, 20), rough=0.07, glass=1.0)
TRIM = Ink((20, 20, 21), rough=0.75)
BODY = Ink((255, 255, 255), paint=1.0, metal=0.25, rough=0.25)
CHROME = Ink((150, 152, 155), metal=0.8, rough=0.25)
HEADLAMP = Ink((222, 226, 232), metal=0.2, rough=0.1, glass=0.5)
TAIL_LAMP = Ink((168, 12, 10), rough=0.14, glass=0.25)
PLATE = Ink((226, 226, 222), rough=0.5)


class Picture:
    """A square picture that covers ``x_m[0]..x_m[1]`` to the right and ``z_m[0]..z_m[1]`` upwards, all ``ground`` at
    first. Either range may run backwards, which mirrors the picture."""

    def __init__(self, x_m: tuple[float, float], z_m: tuple[float, float], ground: Ink) -> None:
        size_px = LAYER_PX * _SUPERSAMPLING
        self._x_m, self._z_m = x_m, z_m
        self.color: NDArray[np.uint8] = np.empty((size_px, size_px, 4), dtype=np.uint8)
        self.surface: NDArray[np.uint8] = np.empty((size_px, size_px, 3), dtype=np.uint8)
        self.color[...] = _color(ground)
        self.surface[...] = _surface(ground)

    def polygon(self, points_m: ArrayLike, ink: Ink) -> None:
        """A filled polygon through (N, 2) points."""
        points = [self._pixels(points_m)]
        cv2.fillPoly(self.color, points, _color(ink), cv2.LINE_AA, _SHIFT)
        cv2.fillPoly(self.surface, points, _surface(ink), cv2.LINE_AA, _SHIFT)

    def rectangle(self, x_m: tuple[float, float], z_m: tuple[float, float], ink: Ink) -> None:
        """A filled rectangle."""
        self.polygon([(x_m[0], z_m[0]), (x_m[1], z_m[0]), (x_m[1], z_m[1]), (x_m[0], z_m[1])], ink)

    def ellipse(self, center_m: tuple[float, float], radii_m: tuple[float, float], ink: Ink) -> None:
        """A filled ellipse along the axes."""
        angle = np.linspace(0, 2 * np.pi, 48, endpoint=False)
        ring = np.stack([np.cos(angle) * radii_m[0], np.sin(angle) * radii_m[1]], axis=1)
        self.polygon(np.asarray(center_m) + ring, ink)

    def line(self, points_m: ArrayLike, width_px: int, ink: Ink) -> None:
        """An open line, ``width_px`` wide in the finished picture."""
        points = [self._pixels(points_m)]
        width = width_px * _SUPERSAMPLING
        cv2.polylines(self.color, points, False, _color(ink), width, cv2.LINE_AA, _SHIFT)

    def text(self, words: str, at_m: tuple[float, float], height_m: float, ink: Ink, *, broader: float = 1.0) -> None:
        """Words whose capitals are ``height_m`` high, from their lower left corner, ``broader`` than they usually are.
        They read rightly, however the picture is stretched and whichever way its ranges run."""
        if not words:
            return
        (wide, tall), descent = cv2.getTextSize(words, cv2.FONT_HERSHEY_SIMPLEX, 2.0, 6)
        drawn = np.zeros((tall + descent + 8, wide + 8), dtype=np.uint8)
        cv2.putText(drawn, words, (4, tall + 4), cv2.FONT_HERSHEY_SIMPLEX, 2.0, 255, 6, cv2.LINE_AA)
        left, top, wide, tall = cv2.boundingRect(drawn)
        stencil = drawn[top : top + tall, left : left + wide]
        size_px = self.color.shape[0]
        per_x_px = size_px / abs(self._x_m[1] - self._x_m[0])
        per_z_px = size_px / abs(self._z_m[1] - self._z_m[0])
        left, base = (int(value) for value in self._pixels([at_m])[0] >> _SHIFT)
        high = max(2, round(height_m * per_z_px))
        broad = max(2, round(height_m / tall * wide * per_x_px * broader))
        small = np.asarray(cv2.resize(stencil, (broad, high), interpolation=cv2.INTER_AREA), dtype=np.float64) / 255
        rows, columns = slice(max(0, base - high), base), slice(left, min(size_px, left + broad))
        cover = small[high - (rows.stop - rows.start) :, : columns.stop - columns.start, None]
        for image, value in ((self.color, _color(ink)), (self.surface, _surface(ink))):
            image[rows, columns] = np.round(image[rows, columns] * (1 - cover) + np.array(value) * cover)

    def _pixels(self, points_m: ArrayLike) -> NDArray[np.int32]:
        points = np.asarray(points_m, dtype=np.float64)
        size_px = self.color.shape[0]
        x = (points[:, 0] - self._x_m[0]) / (self._x_m[1] - self._x_m[0])
        z = (points[:, 1] - self._z_m[0]) / (self._z_m[1] - self._z_m[0])
        places = np.stack([x, 1 - z], axis=1) * (size_px << _SHIFT)
        return np.asarray(np.round(places), dtype=np.int32)


@dataclass
class TextureSet:
    """The layers of all meshes of a world, each ``LAYER_PX`` square: RGBA in sRGB, and metal, roughness, glass. Row 0
    of a layer is its top; meshes give v = 0 there."""

    _color: list[NDArray[np.uint8]] = field(default_factory=list[NDArray[np.uint8]])
    _surface: list[NDArray[np.uint8]] = field(default_factory=list[NDArray[np.uint8]])

    def add(self, picture: Picture) -> int:
        """The new layer's number."""
        return self.add_images(picture.color, picture.surface)

    def add_images(self, color: NDArray[np.uint8], surface: NDArray[np.uint8]) -> int:
        """Adds an (H, W, 4) and an (H, W, 3) image, shrunk to the layer's size."""
        size = (LAYER_PX, LAYER_PX)
        self._color.append(np.asarray(cv2.resize(color, size, interpolation=cv2.INTER_AREA), dtype=np.uint8))
        self._surface.append(np.asarray(cv2.resize(surface, size, interpolation=cv2.INTER_AREA), dtype=np.uint8))
        return len(self._color) - 1

    def __len__(self) -> int:
        return len(self._color)

    @property
    def color(self) -> Sequence[NDArray[np.uint8]]:
        """(LAYER_PX, LAYER_PX, 4) each"""
        return self._color

    @property
    def surface(self) -> Sequence[NDArray[np.uint8]]:
        """(LAYER_PX, LAYER_PX, 3) each"""
        return self._surface


def rgb_of(values: ArrayLike) -> tuple[float, float, float]:
    """Three numbers as a colour."""
    red, green, blue = (float(value) for value in np.asarray(values, dtype=np.float64))
    return red, green, blue


def tileable_noise(rng: np.random.Generator, size_px: int, cells: Sequence[int]) -> NDArray[np.float64]:
    """(size_px, size_px) noise from 0 to 1 that repeats without a seam: octaves of random cells, smoothed, each of
    half the weight of the one before. ``cells`` counts the cells along a side and divides ``size_px``."""
    total, weight, weights = np.zeros((size_px, size_px)), 1.0, 0.0
    for count in cells:
        values = np.pad(rng.random((count, count)), 2, mode="wrap")
        cell_px = size_px // count
        fine = cv2.resize(values, None, fx=cell_px, fy=cell_px, interpolation=cv2.INTER_CUBIC)
        total += weight * np.asarray(fine)[2 * cell_px : 2 * cell_px + size_px, 2 * cell_px : 2 * cell_px + size_px]
        weights += weight
        weight /= 2
    return np.clip(total / weights, 0.0, 1.0)


def _color(ink: Ink) -> tuple[float, float, float, float]:
    return (*ink.rgb, 255 * ink.paint)


def _surface(ink: Ink) -> tuple[float, float, float]:
    return 255 * ink.metal, 255 * ink.rough, 255 * ink.glass
