"""Colours of the 3D view. An identity has the same colour here as in the camera images."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.scene.types import Theme

Rgb = tuple[int, int, int]

# The page's own colours of identities (frontend/src/review/cameras/palette.ts); a test keeps them the same.
IDENTITY_PALETTE: tuple[Rgb, ...] = (
    (0x56, 0xB4, 0xE9),
    (0xFF, 0xB0, 0x00),
    (0x2F, 0xD3, 0x9A),
    (0xFF, 0x7A, 0x45),
    (0xF0, 0xE4, 0x42),
    (0xE7, 0x9A, 0xC4),
    (0x8C, 0x9E, 0xFF),
    (0xBB, 0xCC, 0x33),
    (0x99, 0xDD, 0xFF),
    (0xEE, 0x88, 0x66),
    (0x44, 0xD7, 0xE8),
    (0xFF, 0xC2, 0xD1),
)
_STEP = 5  # shares no factor with the palette's length: neighbouring ids take colours that lie far apart
_SHADE_ON_LIGHT = 0.72


def identity_color(identity_id: int, theme: Theme = Theme.DARK) -> Rgb:
    """The colour of an identity, 0..255: the page's, a shade darker on a light background, where lines would drown."""
    dozen = identity_id // len(IDENTITY_PALETTE)
    color = IDENTITY_PALETTE[(identity_id * _STEP + dozen) % len(IDENTITY_PALETTE)]
    if theme is Theme.DARK:
        return color
    red, green, blue = (round(channel * _SHADE_ON_LIGHT) for channel in color)
    return red, green, blue


def faded(color: Rgb, background: Rgb) -> Rgb:
    """A colour half gone into the background: what stands back while an object is selected."""
    red, green, blue = ((front + back) // 2 for front, back in zip(color, background, strict=True))
    return red, green, blue


@dataclass(frozen=True)
class ScenePalette:
    """What the scene around the objects looks like in one theme. Quiet, so that the boxes stand out.

    Points run from ``point_low`` on the ground to ``point_high`` a few metres up. ``background`` lies behind it all.
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
        background=(10, 12, 15),
        point_low=(74, 88, 112),
        point_high=(214, 230, 245),
        grid=(46, 52, 62),
        grid_section=(66, 74, 88),
        ego=(235, 238, 242),
        camera=(140, 150, 165),
        unknown_box=(150, 155, 165),
    ),
    Theme.LIGHT: ScenePalette(
        background=(244, 245, 247),
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
