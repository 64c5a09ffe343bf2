"""Colours of the 3D view. An identity has the same colour here as in the camera images."""

from __future__ import annotations

import colorsys
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.scene.types import Theme

Rgb = tuple[int, int, int]

_GOLDEN_ANGLE_DEG = 137.508  # consecutive ids land far apart on the colour wheel
_SATURATION = 0.70
_LIGHTNESS = 0.55


def identity_color(identity_id: int) -> Rgb:
    """The colour of an identity, 0..255. The page computes the same: hue by the golden angle, HSL 70 %, 55 %."""
    hue = (identity_id * _GOLDEN_ANGLE_DEG) % 360 / 360
    red, green, blue = colorsys.hls_to_rgb(hue, _LIGHTNESS, _SATURATION)
    return round(red * 255), round(green * 255), round(blue * 255)


def faded(color: Rgb, background: Rgb) -> Rgb:
    """A colour half gone into the background: what stands back while an object is selected."""
    red, green, blue = ((front + back) // 2 for front, back in zip(color, background, strict=True))
    return red, green, blue


def as_linear(colors: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """sRGB colours 0..255 as linear light, which is how viser's lines take theirs (its points and meshes take sRGB)."""
    share = colors.astype(np.float32) / 255
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return np.round(linear * 255).astype(np.uint8)


@dataclass(frozen=True)
class ScenePalette:
    """What the scene around the objects looks like in one theme. Quiet, so that the boxes stand out.

    Points run from ``point_low`` on the ground to ``point_high`` a few metres up. ``background`` is viser's own.
    """

    background: Rgb
    point_low: Rgb
    point_high: Rgb
    grid: Rgb
    grid_section: Rgb
    ego: Rgb
    camera: Rgb
    unknown_box: Rgb


_PALETTES = {
    Theme.DARK: ScenePalette(
        background=(20, 20, 20),
        point_low=(74, 88, 112),
        point_high=(214, 230, 245),
        grid=(46, 52, 62),
        grid_section=(66, 74, 88),
        ego=(235, 238, 242),
        camera=(140, 150, 165),
        unknown_box=(150, 155, 165),
    ),
    Theme.LIGHT: ScenePalette(
        background=(255, 255, 255),
        point_low=(158, 170, 188),
        point_high=(34, 52, 84),
        grid=(234, 237, 241),
        grid_section=(218, 223, 230),
        ego=(70, 78, 90),
        camera=(120, 130, 145),
        unknown_box=(120, 125, 135),
    ),
}


def scene_palette(theme: Theme) -> ScenePalette:
    """The colours of a theme."""
    return _PALETTES[theme]


def point_colors(
    height_m: NDArray[np.float32], reflectance: NDArray[np.float32], palette: ScenePalette
) -> NDArray[np.uint8]:
    """(N, 3) colours of points from their (N,) height above the ground and (N,) reflectance in 0..1.

    Height gives the shade; reflectance lifts it, so that lane markings and signs show on the flat ground."""
    share = np.clip(height_m / 4.0, 0.0, 1.0) ** 0.7
    share = np.clip(share + 0.55 * reflectance, 0.0, 1.0)[:, None]
    low, high = np.asarray(palette.point_low, np.float32), np.asarray(palette.point_high, np.float32)
    return (low + share * (high - low)).astype(np.uint8)
