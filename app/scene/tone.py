"""Colours for viser's lines, so that they reach the screen as meant.

viser takes line colours as linear light and three.js then tones them down with its ACES film curve, which makes the
page's orange pale. The curve is known (Stephen Hill's fit of the ACES transform, as three.js has it) and undone here:
what is sent is the light that the curve turns into the wanted colour. The brightest colours lie beyond what can be
sent: they are darkened by the least that is needed, with their hue kept. The purest ones stay a little pale.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_TO_FILM = np.array([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]])
_FROM_FILM = np.array([[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]])
_EXPOSURE = 1 / 0.6
_DARKENINGS = np.linspace(1.0, 0.5, 51)  # of light; the first whose result can be sent is taken


def line_colors(colors: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """(N, 3) values to send for lines that shall look like (N, 3) sRGB ``colors``, 0..255."""
    wanted = _DARKENINGS[:, None, None] * _linear(colors)
    light = _before_film(wanted)
    first = np.argmax((light <= 1.0).all(axis=2), axis=0)
    chosen = light[first, np.arange(len(colors))]
    return np.round(np.clip(chosen, 0.0, 1.0) * 255).astype(np.uint8)


def _linear(colors: NDArray[np.uint8]) -> NDArray[np.float64]:
    share = colors.astype(np.float64) / 255
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def _before_film(light: NDArray[np.float64]) -> NDArray[np.float64]:
    """The light (..., 3) that the curve turns into ``light``. The curve is a ratio of squares, so a root is taken."""
    curve = light @ np.linalg.inv(_FROM_FILM).T
    square, first, constant = 1 - 0.983729 * curve, 0.0245786 - 0.4329510 * curve, -0.000090537 - 0.238081 * curve
    film = (-first + np.sqrt(first**2 - 4 * square * constant)) / (2 * square)
    return film @ np.linalg.inv(_TO_FILM).T / _EXPOSURE
