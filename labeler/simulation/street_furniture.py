"""Lamps, signals, benches, bins, hydrants: the small things beside a street. x is where their front looks."""

from labeler.simulation.blocks import FurnitureKind
from labeler.simulation.dimensions import KERB_HEIGHT_M, LAMP_SPACING_M
from labeler.simulation.layout import Signal
from labeler.simulation.materials import Material, Semantic, Shading
from labeler.simulation.meshes import Mesh, Surface, box, cylinder, disc, join

_POST = Surface((0.09, 0.095, 0.10), Material.METAL, rough=0.6)
_HOUSING = Surface((0.035, 0.04, 0.035), Material.PLASTIC, rough=0.6)
_LAMP_RADIUS_M = 0.11
_FRONT_M = 0.16
"""How far a signal's lamps stand before the middle of its head."""


def lamp_mesh() -> Mesh:
    """A street lamp of 7.4 m whose arm points along x."""
    return join([
        cylinder((0, 0, 0), (0, 0, 7.2), 0.09, _POST, end_radius_m=0.06, sides=8),
        cylinder((0, 0, 0), (0, 0, 0.6), 0.16, _POST, end_radius_m=0.13, sides=8),
        cylinder((0, 0, 7.1), (1.7, 0, 7.45), 0.045, _POST, sides=6),
        box((1.3, -0.13, 7.40), (2.0, 0.13, 7.52), Surface((0.17, 0.17, 0.18), Material.METAL, rough=0.5)),
        box((1.4, -0.10, 7.385), (1.9, 0.10, 7.40), Surface((0.75, 0.74, 0.68), Material.GLASS, rough=0.2)),
    ])  # fmt: skip


def signal_mesh(signal: Signal) -> Mesh:
    """A signal's pole, arm and heads in the world's frame, without the lamps."""
    z_m = KERB_HEIGHT_M
    pole = (signal.x_m, signal.y_m)
    top_m = max(head[2] for head in signal.heads_m) + 1.1
    parts = [cylinder((*pole, z_m), (*pole, top_m), 0.11, _POST, end_radius_m=0.08, sides=8)]
    for x_m, y_m, green_m in signal.heads_m:
        if (x_m, y_m) != pole:
            parts.append(cylinder((*pole, top_m - 0.2), (x_m, y_m, top_m), 0.06, _POST, end_radius_m=0.05, sides=6))
        parts.append(_head().placed((x_m, y_m, green_m), yaw_rad=signal.heading_rad))
    return join(parts)


def _head() -> Mesh:
    """A head whose green lamp is at the origin; its lamps look along -x."""
    top_m = 2 * LAMP_SPACING_M + 0.19
    parts = [box((-_FRONT_M + 0.01, -0.18, -0.19), (0.12, 0.18, top_m), _HOUSING)]
    yellow = Surface((0.50, 0.36, 0.02), Material.METAL, rough=0.6)
    parts.append(box((0.05, -0.26, -0.27), (0.08, 0.26, top_m + 0.08), yellow))
    for k in range(3):
        z_m = k * LAMP_SPACING_M
        parts.append(box((-_FRONT_M - 0.14, -0.13, z_m + 0.115), (-_FRONT_M + 0.01, 0.13, z_m + 0.13), _HOUSING))
    return join(parts)


def lamp_places_m(signal: Signal) -> list[tuple[tuple[float, float, float], str]]:
    """The middle of each lamp of a signal and its colour: green, yellow or red."""
    cos, sin = _unit(signal.heading_rad)
    return [
        ((x_m - cos * _FRONT_M, y_m - sin * _FRONT_M, z_m + k * LAMP_SPACING_M), color)
        for x_m, y_m, z_m in signal.heads_m
        for k, color in enumerate(("green", "yellow", "red"))
    ]


def lamp_disc() -> Mesh:
    """One lamp of a signal, which looks along -x and shines in its instance's paint."""
    glass = Surface((1.0, 1.0, 1.0), Material.GLASS, paint=1.0, rough=0.3, shading=Shading.LIGHT)
    return disc((0, 0, 0), (-1, 0, 0), _LAMP_RADIUS_M, glass, sides=14)


def furniture_mesh(kind: FurnitureKind) -> Mesh:
    """A small thing in its own frame, standing on z = 0."""
    wood = Surface((0.24, 0.13, 0.06), Material.WOOD, rough=0.8, semantic=Semantic.OTHER)
    green = Surface((0.03, 0.12, 0.07), Material.METAL, rough=0.6)
    red = Surface((0.45, 0.03, 0.02), Material.METAL, rough=0.5)
    grey = Surface((0.32, 0.34, 0.33), Material.METAL, rough=0.6)
    if kind == "bench":
        legs = [box((-0.2, y, 0), (0.2, y + 0.06, 0.42), _POST) for y in (-0.8, 0.74)]
        back = box((-0.24, -0.9, 0.50), (-0.19, 0.9, 0.88), wood)
        return join([*legs, box((-0.22, -0.9, 0.40), (0.24, 0.9, 0.46), wood), back])
    if kind == "bin":
        lid = cylinder((0, 0, 0.85), (0, 0, 0.95), 0.27, _POST)
        return join([cylinder((0, 0, 0.05), (0, 0, 0.85), 0.24, green), lid])
    if kind == "hydrant":
        return join([
            cylinder((0, 0, 0), (0, 0, 0.62), 0.11, red, sides=10),
            cylinder((0, 0, 0.62), (0, 0, 0.74), 0.13, red, end_radius_m=0.03, sides=10),
            cylinder((0, -0.2, 0.46), (0, 0.2, 0.46), 0.06, red, sides=8),
        ])  # fmt: skip
    return join([box((-0.2, -0.45, 0), (0.2, 0.45, 1.15), grey), box((-0.23, -0.48, 1.15), (0.23, 0.48, 1.2), grey)])


def _unit(angle_rad: float) -> tuple[float, float]:
    """Cosine and sine of a quarter turn, exactly."""
    quarter = round(angle_rad / 1.5707963267948966) % 4
    return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[quarter]
