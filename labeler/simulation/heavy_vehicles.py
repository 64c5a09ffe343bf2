"""Buses and trucks, from rounded boxes with drawn sides."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from labeler.simulation.materials import Material
from labeler.simulation.meshes import Mesh, Surface, box, cylinder, join
from labeler.simulation.rounded_box import BoxLayers, rounded_box
from labeler.simulation.textures import (
    BODY,
    CHROME,
    HEADLAMP,
    PLATE,
    TAIL_LAMP,
    TRIM,
    WINDOW,
    Ink,
    Picture,
    TextureSet,
    rgb_of,
)
from labeler.simulation.wheels import wheel

_SEAM = Ink((60, 60, 62), rough=0.6)
_INDICATOR = Ink((232, 145, 30), rough=0.2)
_DARK = Surface((0.03, 0.03, 0.03), rough=0.9)
_GREY = Surface((0.45, 0.45, 0.46), Material.METAL, metal=0.3, rough=0.5)
_PAINTED = Surface((1.0, 1.0, 1.0), Material.PAINT, paint=1.0, rough=0.35)
_WHEEL_SIDES = (24, 16, 8)
_CARGO_COLORS = ((236, 236, 234), (228, 230, 233), (214, 206, 190), (60, 96, 150), (178, 60, 50), (70, 120, 86))


@dataclass(frozen=True)
class HeavyShape:
    """A bus or truck: lengths in metres, axles as x from the middle."""

    style: str
    category: str
    length_m: float
    width_m: float
    height_m: float
    floor_m: float
    wheel_radius_m: float
    axles_m: tuple[float, ...]


BUS_SHAPES = (
    HeavyShape("city-bus", "bus", 11.8, 2.52, 3.05, 0.30, 0.48, (3.25, -2.75)),
    HeavyShape("coach", "bus", 12.2, 2.52, 3.45, 0.34, 0.50, (3.6, -2.5, -3.9)),
    HeavyShape("midi-bus", "bus", 8.6, 2.35, 2.90, 0.30, 0.43, (2.35, -2.0)),
)
TRUCK_SHAPES = (
    HeavyShape("box-truck", "truck", 7.4, 2.36, 3.15, 0.45, 0.43, (2.6, -2.1)),
    HeavyShape("long-truck", "truck", 9.4, 2.48, 3.65, 0.55, 0.50, (3.4, -2.2, -3.5)),
    HeavyShape("dump-truck", "truck", 7.8, 2.46, 3.05, 0.60, 0.52, (2.7, -1.4, -2.75)),
)


def bus_meshes(textures: TextureSet, shape: HeavyShape, rng: np.random.Generator, rim_layer: int) -> tuple[Mesh, ...]:
    """A bus at each level of detail. Its door side is the right one."""
    s = shape
    body_m = s.height_m - 0.20
    layers = _bus_layers(textures, s, body_m, rng)
    low, high = (
        np.array([-s.length_m / 2, -s.width_m / 2, s.floor_m]),
        np.array([s.length_m / 2, s.width_m / 2, body_m]),
    )
    fittings = [
        box((-s.length_m * 0.32, -0.75, body_m - 0.02), (-s.length_m * 0.05, 0.75, s.height_m), _GREY),
        box((s.length_m * 0.12, -0.6, body_m - 0.02), (s.length_m * 0.28, 0.6, s.height_m - 0.04), _GREY),
    ]
    for sign in (-1, 1):
        ends = sorted((sign * (s.width_m / 2 - 0.02), sign * (s.width_m / 2 + 0.20)))
        x_m = s.length_m / 2
        fittings.append(box((x_m - 0.22, ends[0], 1.85), (x_m - 0.08, ends[1], 2.35), _DARK))
    return tuple(
        join([rounded_box(low, high, 0.22, layers, steps=steps), *fittings, *_axles(s, rim_layer, detail)])
        for detail, steps in enumerate((4, 2, 1))
    )


def truck_meshes(textures: TextureSet, shape: HeavyShape, rng: np.random.Generator, rim_layer: int) -> tuple[Mesh, ...]:
    """A truck with a cab and a closed box or an open bed, at each level of detail."""
    s = shape
    cab_m, gap_m = (1.75, 0.12) if s.style == "box-truck" else (2.05, 0.15)
    cab_top_m = min(s.height_m - 0.35, 2.35 if s.style == "box-truck" else 2.95)
    nose_m, behind_m, half_m = s.length_m / 2, s.length_m / 2 - cab_m, s.width_m / 2
    cab = _cab_layers(textures, s, cab_m, cab_top_m, rng)
    frame = box((-s.length_m / 2 + 0.15, -0.48, s.floor_m), (nose_m - 0.3, 0.48, s.floor_m + 0.42), _DARK)
    parts = [frame, *_truck_fittings(s, behind_m, cab_top_m)]
    if s.style == "dump-truck":
        parts += _open_bed(s, behind_m - gap_m)
        cargo: BoxLayers | None = None
    else:
        cargo = _cargo_layers(textures, s, behind_m - gap_m, rng)
    meshes: list[Mesh] = []
    for detail, steps in enumerate((3, 2, 1)):
        low, high = (behind_m, -half_m * 0.95, s.floor_m - 0.05), (nose_m, half_m * 0.95, cab_top_m)
        bodies = [rounded_box(low, high, 0.16, cab, steps=steps)]
        if cargo is not None:
            low, high = (-s.length_m / 2, -half_m, s.floor_m + 0.42), (behind_m - gap_m, half_m, s.height_m)
            bodies.append(rounded_box(low, high, 0.04, cargo, steps=1))
        meshes.append(join([*bodies, *parts, *_axles(s, rim_layer, detail)]))
    return tuple(meshes)


def _axles(s: HeavyShape, rim_layer: int, detail: int) -> list[Mesh]:
    width_m = 0.32
    one = wheel(s.wheel_radius_m, width_m, rim_layer, sides=_WHEEL_SIDES[detail])
    side_m = s.width_m / 2 - width_m / 2 + 0.005
    return [one.placed((x_m, sign * side_m, s.wheel_radius_m)) for x_m in s.axles_m for sign in (-1, 1)]


def _bus_layers(textures: TextureSet, s: HeavyShape, top_m: float, rng: np.random.Generator) -> BoxLayers:
    band = Ink(rgb_of(rng.integers(40, 220, size=3)), rough=0.3)
    line = f"{rng.integers(10, 99)} " + str(rng.choice(["CENTER", "STATION", "HARBOUR", "PARK"]))
    half_m, z_m = s.length_m / 2, (s.floor_m, top_m)
    sides = [Picture((-half_m, half_m) if right else (half_m, -half_m), z_m, BODY) for right in (False, True)]
    for right, side in enumerate(sides):
        _bus_side(side, s, top_m, band, doors=bool(right))
    w = s.width_m
    front, rear = Picture((-w / 2, w / 2), z_m, BODY), Picture((-w / 2, w / 2), z_m, BODY)
    front.rectangle((-0.46 * w, 0.46 * w), (1.05, top_m - 0.42), WINDOW)
    front.line([(0, 1.05), (0, top_m - 0.42)], 1, _SEAM)
    front.line([(-0.2, 1.08), (-0.75, 1.55)], 1, _SEAM)
    front.rectangle((-0.40 * w, 0.40 * w), (top_m - 0.36, top_m - 0.12), Ink((12, 12, 12), rough=0.3))
    front.text(line, (-0.85, top_m - 0.30), 0.12, Ink((255, 176, 40), rough=0.5))
    front.rectangle((-w / 2, w / 2), (s.floor_m, s.floor_m + 0.14), TRIM)
    front.rectangle((-0.24 * w, 0.24 * w), (0.52, 0.70), _SEAM)
    front.rectangle((-0.26, 0.26), (0.50, 0.61), PLATE)
    rear.rectangle((-0.40 * w, 0.40 * w), (top_m - 1.05, top_m - 0.35), WINDOW)
    rear.rectangle((-0.36 * w, 0.36 * w), (0.75, 1.20), _SEAM)
    for z in np.linspace(0.80, 1.15, 6):
        rear.line([(-0.34 * w, z), (0.34 * w, z)], 1, TRIM)
    rear.rectangle((-0.26, 0.26), (0.52, 0.63), PLATE)
    rear.rectangle((-w / 2, w / 2), (s.floor_m, s.floor_m + 0.14), TRIM)
    for sign in (-1, 1):
        front.ellipse((sign * 0.40 * w, 0.72), (0.13, 0.10), HEADLAMP)
        front.ellipse((sign * 0.30 * w, 0.70), (0.09, 0.08), HEADLAMP)
        rear.rectangle((sign * 0.43 * w, sign * 0.48 * w), (0.75, 1.35), TAIL_LAMP)
        rear.rectangle((sign * 0.36 * w, sign * 0.42 * w), (top_m - 0.25, top_m - 0.18), TAIL_LAMP)
    top = Picture((-half_m, half_m), (-w / 2, w / 2), Ink((215, 215, 215), rough=0.6))
    numbers = [textures.add(picture) for picture in (*sides, front, rear, top)]
    return BoxLayers(*numbers)


def _bus_side(side: Picture, s: HeavyShape, top_m: float, band: Ink, *, doors: bool) -> None:
    half_m, sill_m = s.length_m / 2, 1.15 if s.style != "coach" else 1.60
    head_m = top_m - 0.38
    side.rectangle((-half_m, half_m), (sill_m - 0.42, sill_m - 0.18), band)
    side.rectangle((-half_m + 0.25, half_m - 0.12), (sill_m, head_m), Ink((13, 13, 14), rough=0.25))
    count = round((s.length_m - 0.8) / 1.45)
    edges = np.linspace(-half_m + 0.30, half_m - 0.20, count + 1)
    for start, end in pairwise(edges):
        side.rectangle((float(start) + 0.04, float(end) - 0.05), (sill_m + 0.05, head_m - 0.05), WINDOW)
        side.line([(start + 0.04, head_m - 0.32), (end - 0.05, head_m - 0.32)], 1, _SEAM)
    for x_m in (half_m - 1.75, -0.6) if doors else ():
        side.rectangle((x_m, x_m + 1.25), (s.floor_m + 0.06, head_m), Ink((70, 72, 75), rough=0.4))
        for k in range(2):
            side.rectangle((x_m + 0.06 + 0.6 * k, x_m + 0.58 + 0.6 * k), (s.floor_m + 0.18, head_m - 0.06), WINDOW)
    side.rectangle((-half_m, half_m), (s.floor_m, s.floor_m + 0.12), TRIM)
    for axle_m in s.axles_m:
        side.ellipse((axle_m, s.wheel_radius_m), _round(s.wheel_radius_m + 0.10), Ink((6, 6, 6), rough=0.95))
    side.rectangle((-half_m, -half_m + 0.12), (0.85, 1.05), TAIL_LAMP)
    side.rectangle((half_m - 0.14, half_m), (0.64, 0.80), HEADLAMP)


def _cab_layers(textures: TextureSet, s: HeavyShape, cab_m: float, top_m: float, rng: np.random.Generator) -> BoxLayers:
    nose_m, low_m, w = s.length_m / 2, s.floor_m - 0.05, s.width_m * 0.95
    z_m, belt_m = (low_m, top_m), low_m + (top_m - low_m) * 0.52
    sides = [
        Picture((nose_m - cab_m, nose_m) if right else (nose_m, nose_m - cab_m), z_m, BODY) for right in (False, True)
    ]
    for side in sides:
        glass = [(-0.20, belt_m), (-cab_m * 0.62, belt_m), (-cab_m * 0.62, top_m - 0.22), (-0.34, top_m - 0.22)]
        side.polygon([(nose_m + x, z) for x, z in glass], WINDOW)
        for x in (-0.16, -cab_m * 0.68):
            side.line([(nose_m + x, low_m + 0.35), (nose_m + x, top_m - 0.15)], 1, _SEAM)
        side.rectangle((nose_m - cab_m * 0.62, nose_m - cab_m * 0.62 + 0.2), (belt_m - 0.2, belt_m - 0.14), _SEAM)
        side.rectangle((nose_m - cab_m, nose_m), (low_m, low_m + 0.2), TRIM)
        axle_m = s.axles_m[0]
        side.ellipse((axle_m, s.wheel_radius_m), _round(s.wheel_radius_m + 0.12), Ink((6, 6, 6), rough=0.95))
    front = Picture((-w / 2, w / 2), z_m, BODY)
    front.rectangle((-0.45 * w, 0.45 * w), (belt_m - 0.05, top_m - 0.20), WINDOW)
    front.rectangle((-0.34 * w, 0.34 * w), (low_m + 0.42, belt_m - 0.28), TRIM)
    for z in np.linspace(low_m + 0.48, belt_m - 0.34, int(rng.integers(3, 6))):
        front.line([(-0.32 * w, z), (0.32 * w, z)], 2, CHROME)
    front.rectangle((-w / 2, w / 2), (low_m, low_m + 0.32), TRIM)
    front.rectangle((-0.26, 0.26), (low_m + 0.1, low_m + 0.21), PLATE)
    for sign in (-1, 1):
        front.rectangle((sign * 0.36 * w, sign * 0.48 * w), (low_m + 0.36, low_m + 0.56), HEADLAMP)
        front.rectangle((sign * 0.42 * w, sign * 0.49 * w), (low_m + 0.58, low_m + 0.64), _INDICATOR)
    rear, top = Picture((-1, 1), (0, 1), BODY), Picture((-1, 1), (0, 1), BODY)
    return BoxLayers(*[textures.add(picture) for picture in (*sides, front, rear, top)])


def _cargo_layers(textures: TextureSet, s: HeavyShape, front_m: float, rng: np.random.Generator) -> BoxLayers:
    ground = Ink(_CARGO_COLORS[int(rng.integers(len(_CARGO_COLORS)))], rough=0.5)
    shade = Ink(rgb_of(np.array(ground.rgb) * 0.86), rough=0.5)
    letters = Ink((30, 60, 150) if sum(ground.rgb) > 500 else (240, 240, 236), rough=0.5)
    name = str(rng.choice(["LOGISTICS", "FRESH FOOD", "MOVERS", "PARCELS", ""]))
    rear_m, z_m = -s.length_m / 2, (s.floor_m + 0.42, s.height_m)
    middle_m = z_m[0] + 0.5 * (z_m[1] - z_m[0])
    sides = [Picture((rear_m, front_m) if right else (front_m, rear_m), z_m, ground) for right in (False, True)]
    for side, start_m in zip(sides, (front_m - 0.6, rear_m + 0.6), strict=True):
        for x in np.arange(rear_m, front_m, 0.6):
            side.line([(x, z_m[0]), (x, z_m[1])], 1, shade)
        side.text(name, (start_m, middle_m), 0.42, letters)
        side.rectangle((rear_m, front_m), (z_m[0], z_m[0] + 0.10), _SEAM)
        for x in np.arange(rear_m + 0.4, front_m, 1.6):
            side.rectangle((x, x + 0.14), (z_m[0] + 0.02, z_m[0] + 0.08), _INDICATOR)
    w = s.width_m
    rear = Picture((-w / 2, w / 2), z_m, ground)
    rear.line([(0, z_m[0]), (0, z_m[1])], 2, _SEAM)
    for sign in (-1, 1):
        rear.line([(sign * 0.12, z_m[0] + 0.1), (sign * 0.12, z_m[1] - 0.1)], 2, CHROME)
        rear.line([(sign * 0.45 * w, z_m[0]), (sign * 0.45 * w, z_m[1])], 1, _SEAM)
    rear.rectangle((-w / 2, w / 2), (z_m[0], z_m[0] + 0.16), TRIM)
    plain = Picture((-1, 1), (0, 1), ground)
    return BoxLayers(*[textures.add(picture) for picture in (*sides, plain, rear, plain)])


def _truck_fittings(s: HeavyShape, behind_m: float, cab_top_m: float) -> list[Mesh]:
    """Mirrors, fuel tank, bumper with tail lamps and a number plate at the rear."""
    red, white = Surface((0.5, 0.02, 0.015), rough=0.2), Surface((0.75, 0.75, 0.72), rough=0.5)
    rear_m, low_m = -s.length_m / 2, s.floor_m + 0.02
    parts = [box((rear_m, -s.width_m * 0.46, low_m), (rear_m + 0.12, s.width_m * 0.46, low_m + 0.22), _DARK)]
    parts.append(box((rear_m - 0.015, -0.26, low_m + 0.05), (rear_m, 0.26, low_m + 0.16), white))
    for sign in (-1, 1):
        ends = sorted((sign * s.width_m * 0.34, sign * s.width_m * 0.45))
        parts.append(box((rear_m - 0.02, ends[0], low_m + 0.04), (rear_m, ends[1], low_m + 0.18), red))
        outer = sorted((sign * (s.width_m * 0.475 - 0.02), sign * (s.width_m / 2 + 0.14)))
        x_m = s.length_m / 2 - 0.35
        parts.append(box((x_m - 0.08, outer[0], cab_top_m - 1.0), (x_m, outer[1], cab_top_m - 0.45), _DARK))
    tank_m = s.wheel_radius_m + 0.05
    start, end = (behind_m - 0.1, s.width_m * 0.36, tank_m), (behind_m - 1.0, s.width_m * 0.36, tank_m)
    parts.append(cylinder(start, end, 0.24, _GREY, sides=10))
    return parts


def _open_bed(s: HeavyShape, front_m: float) -> list[Mesh]:
    """A dump bed: floor, four walls and ribs."""
    rear_m, low_m, top_m, half_m = -s.length_m / 2, s.floor_m + 0.42, s.height_m - 0.55, s.width_m / 2
    earth = Surface((0.10, 0.075, 0.05), Material.GRASS, rough=0.95)
    parts = [
        box((rear_m, -half_m + 0.06, low_m), (front_m, half_m - 0.06, low_m + 0.12), _PAINTED),
        box((front_m - 0.1, -half_m + 0.06, low_m), (front_m, half_m - 0.06, s.height_m), _PAINTED),
        box((rear_m, -half_m + 0.06, low_m), (rear_m + 0.08, half_m - 0.06, top_m), _PAINTED),
        box((rear_m + 0.08, -half_m + 0.14, low_m + 0.1), (front_m - 0.1, half_m - 0.14, top_m - 0.2), earth),
    ]
    for sign in (-1, 1):
        wall = sorted((sign * (half_m - 0.06), sign * (half_m - 0.14)))
        parts.append(box((rear_m, wall[0], low_m), (front_m, wall[1], top_m), _PAINTED))
        rib = sorted((sign * half_m, sign * (half_m - 0.08)))
        places = np.arange(rear_m + 0.2, front_m - 0.1, 0.85)
        parts += [box((x, rib[0], low_m), (x + 0.1, rib[1], top_m), _PAINTED) for x in places]
    return parts


def _round(radius_m: float) -> tuple[float, float]:
    return radius_m, radius_m
