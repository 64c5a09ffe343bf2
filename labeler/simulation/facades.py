"""The fronts of buildings, drawn: walls of a material with rows of windows, and ground floors with shops or doors.

One picture of the upper storeys holds ``BAYS`` windows beside and ``BAYS`` above each other and repeats over the wall;
one of a ground floor holds as many beside each other.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from labeler.simulation.textures import Ink, Picture, TextureSet, rgb_of, tileable_noise

BAYS = 4
BAY_M = 3.2
_SPAN_M = BAYS * BAY_M
_VARIANTS = 2
_BLIND = Ink((152, 147, 138), rough=0.5)
_SIGNS = ("CAFE", "MARKET", "BOOKS", "BANK", "PHARMACY", "HOTEL", "PIZZA", "BAKERY", "FLOWERS", "TOOLS")

Rgb = tuple[float, float, float]


@dataclass(frozen=True)
class Facade:
    """Texture layers of one front: the upper storeys, a ground floor with shops, one with flats."""

    upper: int
    shops: int
    flats: int


def draw_facades(textures: TextureSet, kinds: tuple[str, ...], rng: np.random.Generator) -> dict[str, list[Facade]]:
    """A few facades of each kind: ``brick``, ``plaster``, ``concrete``, ``glass`` or ``stone``."""
    return {kind: [_draw(textures, kind, rng) for _ in range(_VARIANTS)] for kind in kinds}


def _draw(textures: TextureSet, kind: str, rng: np.random.Generator) -> Facade:
    wall = _wall_color(kind, rng)
    frame = _scaled(wall, 0.5) if rng.random() < 0.5 else (225.0, 224.0, 220.0)
    upper = _wall(kind, wall, rng)
    _UPPER[kind](upper, wall, frame, rng)
    shops, flats = _wall(kind, wall, rng), _wall(kind, wall, rng)
    _shop_fronts(shops, frame, rng)
    _flat_fronts(flats, frame, rng)
    return Facade(textures.add(upper), textures.add(shops), textures.add(flats))


def _wall_color(kind: str, rng: np.random.Generator) -> Rgb:
    choices: dict[str, tuple[Rgb, ...]] = {
        "brick": ((150, 84, 64), (132, 76, 62), (164, 108, 84), (112, 70, 60)),
        "plaster": ((214, 198, 166), (206, 180, 160), (190, 198, 190), (222, 214, 200), (200, 168, 130)),
        "concrete": ((158, 156, 150), (176, 172, 164), (138, 138, 138)),
        "glass": ((84, 96, 108), (70, 84, 90), (104, 108, 112)),
        "stone": ((186, 178, 160), (168, 160, 146), (198, 190, 176)),
    }
    colors = choices[kind]
    return colors[int(rng.integers(len(colors)))]


def _wall(kind: str, color: Rgb, rng: np.random.Generator) -> Picture:
    """A wall without openings: stains and, for brick and stone, courses."""
    wall = Picture((0.0, _SPAN_M), (0.0, _SPAN_M), Ink(color, rough=0.85))
    if kind in ("brick", "stone"):
        course_m, joint = (0.16, 1.14) if kind == "brick" else (0.8, 0.86)
        for z_m in np.arange(0.0, _SPAN_M, course_m):
            wall.line([(0.0, z_m), (_SPAN_M, z_m)], 1, Ink(_scaled(color, joint), rough=0.9))
    size_px = wall.color.shape[0]
    stains = tileable_noise(rng, size_px, (4, 16, 64, 256)) - 0.5
    shaded = wall.color[..., :3] * (1 + 0.28 * stains[..., None])
    wall.color[..., :3] = np.clip(shaded, 0, 255).astype(np.uint8)
    return wall


def _punched(picture: Picture, wall: Rgb, frame: Rgb, rng: np.random.Generator, width: float, height: float) -> None:
    """A window in each bay, ``width`` and ``height`` as shares of it, with sill, frame and sometimes a blind."""
    sill, rim = Ink(_scaled(wall, 1.2), rough=0.8), Ink(frame)
    half_x, half_z = width * BAY_M / 2, height * BAY_M / 2
    for row in range(BAYS):
        for bay in range(BAYS):
            x_m, z_m = (bay + 0.5) * BAY_M, (row + 0.5) * BAY_M
            low_m, high_m, pane = z_m - half_z, z_m + half_z, (x_m - half_x, x_m + half_x)
            picture.rectangle((pane[0] - 0.1, pane[1] + 0.1), (low_m - 0.1, high_m + 0.1), rim)
            picture.rectangle(pane, (low_m, high_m), _glass(rng))
            if rng.random() < 0.35:
                blind_m = high_m - 2 * half_z * float(rng.uniform(0.2, 0.8))
                picture.rectangle(pane, (blind_m, high_m), _BLIND)
            picture.line([(x_m, low_m), (x_m, high_m)], 1, rim)
            picture.rectangle((pane[0] - 0.18, pane[1] + 0.18), (low_m - 0.22, low_m - 0.1), sill)


def _brick(picture: Picture, wall: Rgb, frame: Rgb, rng: np.random.Generator) -> None:
    _punched(picture, wall, frame, rng, float(rng.uniform(0.38, 0.55)), float(rng.uniform(0.52, 0.66)))


def _plaster(picture: Picture, wall: Rgb, frame: Rgb, rng: np.random.Generator) -> None:
    width = float(rng.uniform(0.30, 0.42))
    _punched(picture, wall, frame, rng, width, 0.55)
    if rng.random() < 0.6:
        shutter = Ink(rgb_of(rng.uniform(50, 130, size=3)), rough=0.7)
        for row in range(BAYS):
            for bay in range(BAYS):
                for sign in (-1, 1):
                    edge_m = (bay + 0.5) * BAY_M + sign * (width * BAY_M / 2 + 0.12)
                    z_m = (row + 0.5) * BAY_M
                    picture.rectangle((edge_m, edge_m + sign * 0.5), (z_m - 0.9, z_m + 0.9), shutter)


def _concrete(picture: Picture, wall: Rgb, frame: Rgb, rng: np.random.Generator) -> None:
    del wall
    for row in range(BAYS):
        low_m, high_m = (row + 0.32) * BAY_M, (row + 0.82) * BAY_M
        picture.rectangle((0.0, _SPAN_M), (low_m, high_m), Ink(frame))
        for x_m in np.arange(0.0, _SPAN_M - 0.1, BAY_M / 2):
            pane = (float(x_m) + 0.06, float(x_m) + BAY_M / 2 - 0.06)
            picture.rectangle(pane, (low_m + 0.06, high_m - 0.06), _glass(rng))


def _curtain(picture: Picture, wall: Rgb, frame: Rgb, rng: np.random.Generator) -> None:
    del frame
    spandrel = Ink(_scaled(wall, 0.75), rough=0.2, glass=0.6)
    for row in range(BAYS):
        for x_m in np.arange(0.0, _SPAN_M - 0.1, BAY_M / 2):
            pane = (float(x_m) + 0.05, float(x_m) + BAY_M / 2 - 0.05)
            picture.rectangle(pane, (row * BAY_M + 0.85, (row + 1) * BAY_M - 0.08), _glass(rng, bright=1.6))
            picture.rectangle(pane, (row * BAY_M + 0.06, row * BAY_M + 0.78), spandrel)


def _stone(picture: Picture, wall: Rgb, frame: Rgb, rng: np.random.Generator) -> None:
    _punched(picture, wall, frame, rng, 0.42, 0.6)
    for row in range(BAYS):
        ledge = Ink(_scaled(wall, 1.15), rough=0.8)
        picture.rectangle((0.0, _SPAN_M), (row * BAY_M - 0.1, row * BAY_M + 0.16), ledge)
        picture.line([(0.0, row * BAY_M - 0.1), (_SPAN_M, row * BAY_M - 0.1)], 2, Ink(_scaled(wall, 0.6)))


_UPPER: dict[str, Callable[[Picture, Rgb, Rgb, np.random.Generator], None]] = {
    "brick": _brick,
    "plaster": _plaster,
    "concrete": _concrete,
    "glass": _curtain,
    "stone": _stone,
}


def _shop_fronts(picture: Picture, frame: Rgb, rng: np.random.Generator) -> None:
    """Shop windows under one sign board; the picture's whole height is the ground floor."""
    top = _SPAN_M
    board = Ink(rgb_of(rng.uniform(20, 190, size=3)), rough=0.6)
    for bay in range(BAYS):
        x_m = (bay + 0.5) * BAY_M
        door = bay == 1
        foot = 0.02 if door else 0.10
        picture.rectangle((x_m - 1.4, x_m + 1.4), (foot * top, 0.76 * top), Ink(_scaled(frame, 0.6)))
        picture.rectangle((x_m - 1.3, x_m + 1.3), ((foot + 0.02) * top, 0.75 * top), _glass(rng, bright=1.5))
        goods = Ink(rgb_of(rng.uniform(40, 150, size=3)), rough=0.5)
        if not door:
            shelf = (x_m - 1.0, x_m + float(rng.uniform(-0.2, 0.9)))
            picture.rectangle(shelf, ((foot + 0.02) * top, 0.35 * top), goods)
        picture.line([(x_m, foot * top), (x_m, 0.75 * top)], 1, Ink(frame))
    picture.rectangle((0.0, top), (0.79 * top, 0.93 * top), board)
    words = str(rng.choice(_SIGNS))
    start = float(rng.uniform(0.5, 4.0))
    picture.text(words, (start, 0.815 * top), 0.075 * top, Ink((240, 240, 234)), broader=0.4)


def _flat_fronts(picture: Picture, frame: Rgb, rng: np.random.Generator) -> None:
    """Windows at chest height and a door in the second bay."""
    top = _SPAN_M
    for bay in range(BAYS):
        x_m = (bay + 0.5) * BAY_M
        if bay == 1:
            door = Ink(rgb_of(rng.uniform(30, 110, size=3)), rough=0.5)
            picture.rectangle((x_m - 0.75, x_m + 0.75), (0.0, 0.68 * top), Ink(frame))
            picture.rectangle((x_m - 0.6, x_m + 0.6), (0.0, 0.64 * top), door)
            picture.rectangle((x_m - 0.35, x_m + 0.35), (0.38 * top, 0.58 * top), _glass(rng))
            continue
        picture.rectangle((x_m - 0.85, x_m + 0.85), (0.28 * top, 0.74 * top), Ink(frame))
        picture.rectangle((x_m - 0.75, x_m + 0.75), (0.30 * top, 0.72 * top), _glass(rng))
        picture.line([(x_m, 0.30 * top), (x_m, 0.72 * top)], 1, Ink(frame))


def _glass(rng: np.random.Generator, *, bright: float = 1.0) -> Ink:
    value = float(rng.uniform(14, 46)) * bright
    return Ink((value * 0.92, value, value * 1.12), rough=0.08, glass=1.0)


def _scaled(color: Rgb, factor: float) -> Rgb:
    return min(255.0, color[0] * factor), min(255.0, color[1] * factor), min(255.0, color[2] * factor)
