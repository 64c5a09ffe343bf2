"""Wheels: a tyre turned from its cross-section, and a rim drawn on a disc."""

import numpy as np

from labeler.simulation.materials import Material, Shading
from labeler.simulation.meshes import Mesh, Surface, build_mesh, disc, join, smooth_normals
from labeler.simulation.textures import Ink, Picture, TextureSet

_TYRE = Surface((0.018, 0.018, 0.02), Material.RUBBER, rough=0.85)
_RIM_SHARE = 0.68


def draw_rim(textures: TextureSet, spokes: int, *, steel: bool = False) -> int:
    """A rim seen from the side as a texture layer: spokes before a dark drum, or a steel disc with holes."""
    bright, dark = Ink((168, 170, 174), metal=0.6, rough=0.35), Ink((16, 16, 17), rough=0.8)
    rim = Picture((-1.0, 1.0), (-1.0, 1.0), dark)
    rim.ellipse((0, 0), (1.0, 1.0), bright)
    rim.ellipse((0, 0), (0.86, 0.86), bright if steel else dark)
    for spoke in range(spokes):
        angle = 2 * np.pi * (spoke + 0.25) / spokes
        out, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        if steel:
            rim.ellipse((float(out[0]) * 0.55, float(out[1]) * 0.55), (0.12, 0.12), dark)
        else:
            root, end = out * 0.1, out * 0.9
            rim.polygon([root + across * 0.15, end + across * 0.11, end - across * 0.11, root - across * 0.15], bright)
    rim.ellipse((0, 0), (0.24, 0.24), bright)
    rim.ellipse((0, 0), (0.12, 0.12), dark)
    return textures.add(rim)


def wheel(radius_m: float, width_m: float, rim_layer: int, *, sides: int = 20) -> Mesh:
    """A closed wheel about the y axis, centred on the origin."""
    half_m, inner_m = width_m / 2, _RIM_SHARE * radius_m
    outline = [
        (inner_m, -half_m * 0.86), (inner_m, -half_m), (0.92 * radius_m, -half_m), (radius_m, -0.72 * half_m),
        (radius_m, 0.72 * half_m), (0.92 * radius_m, half_m), (inner_m, half_m), (inner_m, half_m * 0.86),
    ]  # fmt: skip
    if sides <= 8:
        outline = [outline[k] for k in (0, 1, 3, 4, 6, 7)]
    angle = np.arange(sides) / sides * 2 * np.pi
    position = np.concatenate(
        [np.stack([r * np.cos(angle), np.full(sides, y), r * np.sin(angle)], axis=1) for r, y in outline]
    )
    faces: list[list[int]] = []
    for ring in range(len(outline) - 1):
        for k in range(sides):
            a, b = ring * sides + k, ring * sides + (k + 1) % sides
            faces += [[a, a + sides, b], [b, a + sides, b + sides]]
    triangles = np.array(faces)
    tyre = build_mesh(position, smooth_normals(position, triangles), triangles, _TYRE)
    rim = Surface((1.0, 1.0, 1.0), Material.METAL, layer=rim_layer, shading=Shading.BODY)
    sides_of_rim = [
        disc((0.0, sign * half_m * 0.86, 0.0), (0.0, sign, 0.0), inner_m, rim, sides=sides) for sign in (-1.0, 1.0)
    ]
    return join([tyre, *sides_of_rim])
