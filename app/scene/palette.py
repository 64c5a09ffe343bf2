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


@dataclass(frozen=True)
class ScenePalette:
    """What the scene around the objects looks like in one theme. Quiet, so that the boxes stand out.

    Points run from ``point_low`` on the ground to ``point_high`` a few metres up.
    """

    point_low: Rgb
    point_high: Rgb
    grid: Rgb
    grid_section: Rgb
    ego: Rgb
    camera: Rgb
    unknown_box: Rgb


_PALETTES = {
    Theme.DARK: ScenePalette(
        point_low=(74, 88, 112),
        point_high=(214, 230, 245),
        grid=(38, 42, 50),
        grid_section=(52, 58, 68),
        ego=(235, 238, 242),
        camera=(140, 150, 165),
        unknown_box=(150, 155, 165),
    ),
    Theme.LIGHT: ScenePalette(
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
