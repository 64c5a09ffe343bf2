"""Motorcycles and scooters, with a rider where they drive."""

import numpy as np

from labeler.simulation.materials import Material
from labeler.simulation.meshes import Mesh, Surface, box, cylinder, ellipsoid, join
from labeler.simulation.textures import rgb_of
from labeler.simulation.wheels import wheel

_DARK = Surface((0.02, 0.02, 0.022), rough=0.7)
_STEEL = Surface((0.35, 0.35, 0.36), Material.METAL, metal=0.8, rough=0.3)
_ENGINE = Surface((0.10, 0.10, 0.105), Material.METAL, metal=0.5, rough=0.5)
_PAINT = Surface((1.0, 1.0, 1.0), Material.PAINT, paint=1.0, rough=0.2)
_LAMP = Surface((0.85, 0.87, 0.9), Material.GLASS, rough=0.1, glass=0.5)
_TAIL = Surface((0.5, 0.02, 0.015), rough=0.2)
_SKIN = Surface((0.42, 0.27, 0.19), rough=0.7)
_WHEEL_SIDES = (20, 12, 8)
_RADIUS_M = 0.31
_WHEELBASE_M = 1.42


def motorcycle_mesh(rim_layer: int, rng: np.random.Generator, detail: int, *, rider: bool, scooter: bool) -> Mesh:
    """One motorcycle at a level of detail, x forward, standing on z = 0 and centred between its wheels."""
    radius_m = 0.25 if scooter else _RADIUS_M
    front_m, rear_m = _WHEELBASE_M / 2, -_WHEELBASE_M / 2
    one = wheel(radius_m, 0.13, rim_layer, sides=_WHEEL_SIDES[detail])
    parts = [one.placed((front_m, 0, radius_m)), one.placed((rear_m, 0, radius_m))]
    parts += _scooter_body(radius_m) if scooter else _motorcycle_body(radius_m)
    for sign in (-1, 1):
        parts.append(cylinder((0.42, sign * 0.07, 0.92), (front_m, sign * 0.09, radius_m), 0.03, _STEEL, sides=6))
        parts.append(cylinder((0.36, 0.0, 1.00), (0.30, sign * 0.36, 1.05), 0.018, _DARK, sides=6))
        parts.append(cylinder((0.37, sign * 0.24, 1.02), (0.37, sign * 0.30, 1.22), 0.01, _DARK, sides=4))
        parts.append(ellipsoid((0.37, sign * 0.31, 1.24), (0.02, 0.07, 0.05), _DARK, rings=4, sides=6))
    parts.append(ellipsoid((0.56, 0, 0.88), (0.08, 0.09, 0.09), _LAMP, rings=6, sides=8))
    parts.append(box((rear_m - 0.22, -0.07, 0.68), (rear_m - 0.17, 0.07, 0.76), _TAIL))
    parts.append(box((rear_m - 0.24, -0.09, 0.48), (rear_m - 0.22, 0.09, 0.60), Surface((0.75, 0.75, 0.72))))
    if rider:
        parts += _rider(rng, detail)
    return join(parts)


def _motorcycle_body(radius_m: float) -> list[Mesh]:
    rear_m = -_WHEELBASE_M / 2
    return [
        ellipsoid((0.14, 0, 0.86), (0.30, 0.15, 0.14), _PAINT, rings=8, sides=12),
        box((-0.60, -0.13, 0.74), (-0.08, 0.13, 0.84), _DARK),
        ellipsoid((-0.55, 0, 0.76), (0.28, 0.11, 0.10), _PAINT, rings=6, sides=8),
        box((-0.18, -0.11, 0.34), (0.26, 0.11, 0.70), _ENGINE),
        cylinder((0.30, 0.0, 0.70), (0.44, 0.0, 0.95), 0.05, _DARK, sides=6),
        cylinder((-0.15, 0.09, 0.45), (rear_m, 0.09, radius_m), 0.035, _DARK, sides=6),
        cylinder((-0.15, -0.09, 0.45), (rear_m, -0.09, radius_m), 0.035, _DARK, sides=6),
        cylinder((0.10, -0.17, 0.34), (rear_m - 0.05, -0.17, 0.40), 0.045, _STEEL, sides=8),
        ellipsoid((_WHEELBASE_M / 2, 0, 0.60), (0.26, 0.08, 0.06), _PAINT, rings=6, sides=8),
        ellipsoid((0.44, 0, 0.98), (0.16, 0.18, 0.16), _PAINT, rings=6, sides=8),
    ]


def _scooter_body(radius_m: float) -> list[Mesh]:
    rear_m = -_WHEELBASE_M / 2
    return [
        ellipsoid((-0.45, 0, 0.56), (0.45, 0.19, 0.24), _PAINT, rings=8, sides=12),
        box((-0.70, -0.14, 0.74), (-0.10, 0.14, 0.84), _DARK),
        box((-0.15, -0.17, 0.24), (0.40, 0.17, 0.34), _DARK),
        ellipsoid((0.45, 0, 0.66), (0.10, 0.23, 0.36), _PAINT, rings=8, sides=10),
        cylinder((0.45, 0, 0.60), (0.38, 0, 1.00), 0.04, _DARK, sides=6),
        ellipsoid((_WHEELBASE_M / 2, 0, radius_m + 0.18), (0.22, 0.08, 0.08), _PAINT, rings=6, sides=8),
        box((rear_m - 0.22, -0.16, 0.78), (rear_m + 0.16, 0.16, 1.06), _DARK),
    ]


def _rider(rng: np.random.Generator, detail: int) -> list[Mesh]:
    """A person sitting upright with hands on the bar, helmet on."""
    sides = (10, 8, 6)[detail]
    jacket = Surface(rgb_of(rng.uniform(0.02, 0.5, size=3)), rough=0.85)
    trousers = Surface(rgb_of(rng.uniform(0.02, 0.12, size=3)), rough=0.9)
    helmet = Surface(rgb_of(rng.uniform(0.03, 0.8, size=3)), rough=0.2)
    visor = Surface((0.01, 0.012, 0.015), Material.GLASS, rough=0.06, glass=1.0)
    parts = [
        cylinder((-0.28, 0, 0.84), (-0.12, 0, 1.36), 0.17, jacket, end_radius_m=0.20, sides=sides),
        ellipsoid((-0.11, 0, 1.38), (0.13, 0.23, 0.12), jacket, rings=6, sides=sides),
        ellipsoid((-0.02, 0, 1.62), (0.15, 0.13, 0.16), helmet, rings=8, sides=sides),
        ellipsoid((0.05, 0, 1.61), (0.10, 0.11, 0.06), visor, rings=6, sides=sides),
        cylinder((-0.07, 0, 1.42), (-0.04, 0, 1.52), 0.06, _SKIN, sides=6),
    ]
    for sign in (-1, 1):
        parts.append(cylinder((-0.11, sign * 0.22, 1.38), (0.08, sign * 0.30, 1.14), 0.06, jacket, sides=sides))
        parts.append(cylinder((0.08, sign * 0.30, 1.14), (0.31, sign * 0.30, 1.07), 0.05, jacket, sides=sides))
        parts.append(cylinder((-0.25, sign * 0.12, 0.88), (0.16, sign * 0.21, 0.80), 0.09, trousers, sides=sides))
        parts.append(cylinder((0.16, sign * 0.21, 0.80), (0.0, sign * 0.21, 0.40), 0.07, trousers, sides=sides))
        parts.append(box((-0.06, sign * 0.21 - 0.05, 0.30), (0.20, sign * 0.21 + 0.05, 0.40), _DARK))
    return parts
