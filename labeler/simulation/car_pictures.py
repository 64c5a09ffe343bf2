"""The pictures of a car's side, front, rear and top: windows, doors, lamps, grille, number plates, wheel arches."""

import numpy as np

from labeler.simulation.car_body import BodyLayers
from labeler.simulation.car_shapes import CarShape
from labeler.simulation.textures import BODY, CHROME, HEADLAMP, PLATE, TAIL_LAMP, TRIM, WINDOW, Ink, Picture, TextureSet

_SEAM = Ink((18, 18, 19), rough=0.6)
_ARCH = Ink((6, 6, 6), rough=0.95)
_GRILLE = Ink((17, 17, 18), rough=0.5)
_REVERSING_LAMP = Ink((225, 215, 205), rough=0.15)
_LETTERS = Ink((25, 25, 30), rough=0.5)


def draw_car(textures: TextureSet, shape: CarShape, rng: np.random.Generator, rim_layer: int) -> BodyLayers:
    """Draws one car's pictures. Cars of one shape differ in trim, grille and plate."""
    chrome, glazed = bool(rng.random() < 0.4), bool(rng.random() < 0.5)
    sunroof, plate = bool(rng.random() < 0.3), _plate(rng)
    return BodyLayers(
        side=textures.add(_side(shape, chrome=chrome, glazed=glazed)),
        front=textures.add(_front(shape, plate, bars=int(rng.integers(2, 6)), chrome=chrome)),
        rear=textures.add(_rear(shape, plate)),
        top=textures.add(_top(shape, sunroof=sunroof)),
        rim=rim_layer,
    )


def _plate(rng: np.random.Generator) -> str:
    letters = "".join(chr(65 + k) for k in rng.integers(26, size=3))
    return f"{letters} {rng.integers(100, 1000)}"


def _side(s: CarShape, *, chrome: bool, glazed: bool) -> Picture:
    picture = Picture((-s.length_m / 2, s.length_m / 2), (0.0, s.height_m), BODY)
    sill_m, glass_m = s.sill_m, s.belt_m + 0.015
    _side_windows(picture, s, glass_m, glazed=glazed)
    for at in s.doors:
        picture.line([(s.x_at(at), glass_m), (s.x_at(at), sill_m + 0.10)], 1, _SEAM)
    picture.line([(s.x_at(s.doors[0]), sill_m + 0.10), (s.x_at(s.doors[-1]), sill_m + 0.10)], 1, _SEAM)
    for at in s.doors[1:]:
        x_m = s.x_at(at - 0.012)
        picture.rectangle((x_m, x_m + 0.16), (s.belt_m - 0.14, s.belt_m - 0.10), CHROME if chrome else _SEAM)
    half_m = s.length_m / 2
    picture.rectangle((-half_m, half_m), (0.0, sill_m + 0.07), TRIM)
    if s.style in ("suv", "pickup"):
        picture.rectangle((-half_m, half_m), (0.0, sill_m + 0.16), TRIM)
    for axle_m in (s.front_axle_m, s.rear_axle_m):
        if s.style in ("suv", "pickup"):
            picture.ellipse((axle_m, s.wheel_radius_m), _round(s.wheel_radius_m + 0.12), TRIM)
        picture.ellipse((axle_m, s.wheel_radius_m), _round(s.wheel_radius_m + 0.06), _ARCH)
    hood_m, tail_m = s.hood_m, s.tail_m
    headlamp = [(0.0, 0.74), (0.055, 0.80), (0.045, 0.66), (0.0, 0.60)]
    picture.polygon([(s.x_at(at), hood_m * z) for at, z in headlamp], HEADLAMP)
    tail_lamp = [(1.0, 0.93), (0.95, 0.90), (0.955, 0.74), (1.0, 0.72)]
    picture.polygon([(s.x_at(at), tail_m * z) for at, z in tail_lamp], TAIL_LAMP)
    return picture


def _side_windows(picture: Picture, s: CarShape, glass_m: float, *, glazed: bool) -> None:
    top_m = s.height_m * (0.90 if s.body == "van" else 0.935)
    if s.body == "van":
        low_m = glass_m + 0.05
        outline = [(s.hood_end + 0.035, low_m), (s.roof_start + 0.02, top_m), (0.40, top_m), (0.40, low_m)]
        picture.polygon([(s.x_at(at), z) for at, z in outline], WINDOW)
        for start, end in ((0.43, 0.66), (0.69, 0.95)) if glazed else ():
            picture.rectangle((s.x_at(end), s.x_at(start)), (glass_m + 0.05, top_m), WINDOW)
        return
    roof_start = s.roof_start + 0.012
    roof_end = s.roof_end - 0.02 if s.body == "pickup" else min(s.roof_end - 0.01, 0.955)
    rear = s.deck_start - 0.02 if s.body == "pickup" else min(s.deck_start - 0.03, 0.965)
    outline = np.array([
        (s.x_at(s.hood_end + 0.04), glass_m), (s.x_at(roof_start), top_m),
        (s.x_at((roof_start + roof_end) / 2), top_m + 0.01), (s.x_at(roof_end), top_m - 0.01),
        (s.x_at(rear), glass_m + 0.02),
    ])  # fmt: skip
    picture.polygon(outline, TRIM)
    middle = outline.mean(axis=0)
    picture.polygon(middle + (outline - middle) * (0.975, 0.93), WINDOW)
    for at in s.pillars:
        picture.rectangle((s.x_at(at + 0.01), s.x_at(at - 0.01)), (glass_m - 0.02, top_m + 0.02), TRIM)


def _front(s: CarShape, plate: str, *, bars: int, chrome: bool) -> Picture:
    w, hood_m = s.width_m, s.hood_m
    picture = Picture((-w / 2, w / 2), (0.0, s.height_m), BODY)
    picture.rectangle((-w / 2, w / 2), (0.0, s.sill_m + 0.10), TRIM)
    grille = [(-0.30, 0.46), (0.30, 0.46), (0.36, 0.70), (-0.36, 0.70)]
    picture.polygon([(y * w, z * hood_m) for y, z in grille], _GRILLE)
    for z in np.linspace(0.50, 0.66, bars):
        picture.line([(-0.31 * w, hood_m * z), (0.31 * w, hood_m * z)], 2 if chrome else 1, CHROME)
    for sign in (-1, 1):
        lamp = [(0.26, 0.77), (0.47, 0.83), (0.47, 0.66), (0.30, 0.63)]
        picture.polygon([(sign * y * w, z * hood_m) for y, z in lamp], HEADLAMP)
        picture.ellipse((sign * 0.39 * w, 0.72 * hood_m), (0.055, 0.05), Ink((245, 246, 250), rough=0.05, glass=0.3))
        picture.rectangle((sign * 0.31 * w, sign * 0.40 * w), (hood_m * 0.34, hood_m * 0.41), CHROME)
    _number_plate(picture, plate, hood_m * 0.43 - 0.11)
    picture.ellipse((0.0, hood_m * 0.73), (0.05, 0.05), CHROME)
    low_m, top_m = hood_m + 0.10, s.height_m * 0.93
    screen = [(-0.40, low_m), (0.40, low_m), (0.36, top_m), (-0.36, top_m)]
    picture.polygon([(y * w, z) for y, z in screen], WINDOW)
    return picture


def _rear(s: CarShape, plate: str) -> Picture:
    w, tail_m = s.width_m, s.tail_m
    picture = Picture((-w / 2, w / 2), (0.0, s.height_m), BODY)
    if s.steep_tail:
        low_m, top_m = s.belt_m + 0.06, s.height_m * 0.91
        screen = [(-0.38, low_m), (0.38, low_m), (0.33, top_m), (-0.33, top_m)]
        picture.polygon([(y * w, z) for y, z in screen], WINDOW)
        if s.body == "van":
            picture.line([(0.0, s.sill_m + 0.2), (0.0, s.height_m * 0.95)], 2, _SEAM)
    for sign in (-1, 1):
        lamp = [(0.27, 0.92), (0.47, 0.95), (0.48, 0.72), (0.31, 0.74)]
        if s.style in ("suv", "wagon", "minivan", "van", "pickup"):
            lamp = [(0.36, 1.04), (0.47, 1.04), (0.48, 0.68), (0.37, 0.68)]
        picture.polygon([(sign * y * w, z * tail_m) for y, z in lamp], TAIL_LAMP)
        picture.rectangle((sign * 0.38 * w, sign * 0.45 * w), (tail_m * 0.76, tail_m * 0.80), _REVERSING_LAMP)
    picture.line([(-0.30 * w, tail_m * 0.97), (0.30 * w, tail_m * 0.97)], 1, _SEAM)
    picture.line([(-0.44 * w, tail_m * 0.62), (0.44 * w, tail_m * 0.62)], 1, _SEAM)
    picture.rectangle((-w / 2, w / 2), (0.0, s.sill_m + 0.14), TRIM)
    _number_plate(picture, plate, tail_m * (0.84 if s.body == "three-box" else 0.72) - 0.11)
    return picture


def _number_plate(picture: Picture, words: str, low_m: float) -> None:
    picture.rectangle((-0.26, 0.26), (low_m, low_m + 0.11), PLATE)
    picture.text(words, (-0.2, low_m + 0.028), 0.054, _LETTERS)


def _top(s: CarShape, *, sunroof: bool) -> Picture:
    w = s.width_m
    picture = Picture((-s.length_m / 2, s.length_m / 2), (-w / 2, w / 2), BODY)
    low, high = s.x_at(s.hood_end + 0.01), s.x_at(s.roof_start - 0.005)
    picture.polygon([(low, 0.42 * w), (high, 0.355 * w), (high, -0.355 * w), (low, -0.42 * w)], WINDOW)
    if s.body != "van":
        low, high = s.x_at(min(s.deck_start - 0.008, 0.985)), s.x_at(s.roof_end + 0.01)
        picture.polygon([(low, 0.40 * w), (high, 0.35 * w), (high, -0.35 * w), (low, -0.40 * w)], WINDOW)
    for sign in (-1, 1):
        picture.line([(s.x_at(0.03), sign * 0.40 * w), (s.x_at(s.hood_end), sign * 0.43 * w)], 1, _SEAM)
    picture.line([(s.x_at(s.hood_end - 0.004), -0.43 * w), (s.x_at(s.hood_end - 0.004), 0.43 * w)], 2, _SEAM)
    if sunroof:
        picture.rectangle((s.x_at(s.roof_start + 0.15), s.x_at(s.roof_start + 0.03)), (-0.24 * w, 0.24 * w), WINDOW)
    return picture


def _round(radius_m: float) -> tuple[float, float]:
    return radius_m, radius_m
