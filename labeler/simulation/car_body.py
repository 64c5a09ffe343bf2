"""The meshes of cars, vans and pickups.

A body is a loft: at each station along its length a closed ring runs from the floor over the sill, the shoulder and
the roof to the other side; neighbouring rings are joined, and the first and last are capped. Windows, lamps and seams
are drawn on four pictures (side, front, rear, top) that are projected on the loft along the axes.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.simulation.car_shapes import CarShape, Profile, profile_of
from labeler.simulation.materials import Material, Shading
from labeler.simulation.meshes import Mesh, Surface, box, build_mesh, join, smooth_normals
from labeler.simulation.wheels import wheel

DETAILS = 3
"""Levels of detail: 0 for near cars, 2 for far ones."""
_STATIONS = (36, 12, 4)
_SIDE_ROWS = ((0.06, 0.30, 0.52, 0.72, 0.88), (0.06, 0.52, 0.88), (0.06, 0.52))
_CABIN_ROWS = ((0.25, 0.5, 0.75, 1.0), (0.5, 1.0), (1.0,))
_ROOF_ROWS = ((0.2, 0.4, 0.6, 0.8, 1.0), (0.4, 0.7, 1.0), (0.5, 1.0))
_WHEEL_SIDES = (24, 16, 8)
_MIRROR_M = 0.10


@dataclass(frozen=True)
class BodyLayers:
    """The texture layers of one car: its sides, front, rear and top, and its rims."""

    side: int
    front: int
    rear: int
    top: int
    rim: int


def car_mesh(shape: CarShape, layers: BodyLayers, detail: int) -> Mesh:
    """The whole car at one level of detail, x forward, standing on z = 0, the body's middle at x = y = 0."""
    return join([body_mesh(shape, layers, detail), *_fittings(shape, detail), *_wheels(shape, layers.rim, detail)])


def body_mesh(shape: CarShape, layers: BodyLayers, detail: int) -> Mesh:
    """The closed body without wheels and mirrors. Its vertices repeat where the picture changes."""
    position, faces = loft(profile_of(shape, _STATIONS[detail]), detail)
    normal = smooth_normals(position, faces)
    face_normal = _face_normals(position, faces)
    picture = _pictures_of(shape, position[faces].mean(axis=1), face_normal)
    parts: list[Mesh] = []
    for number, layer in enumerate((layers.side, layers.front, layers.rear, layers.top)):
        chosen = faces[picture == number]
        used, places = np.unique(chosen, return_inverse=True)
        surface = Surface((1.0, 1.0, 1.0), Material.PAINT, paint=1.0, rough=0.3, layer=layer, shading=Shading.BODY)
        uv = _projected(shape, position[used], number)
        parts.append(build_mesh(position[used], normal[used], places.reshape(-1, 3), surface, uv=uv))
    under = faces[picture == 4]
    used, places = np.unique(under, return_inverse=True)
    dark = Surface((0.02, 0.02, 0.02), Material.PLASTIC, rough=0.9)
    parts.append(build_mesh(position[used], [0.0, 0.0, -1.0], places.reshape(-1, 3), dark))
    return join(parts)


def loft(profile: Profile, detail: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """(V, 3) positions and (F, 3) faces of the closed surface through a profile's rings, faces turned outwards."""
    half = [_half_ring(profile, k, detail) for k in range(len(profile.x_m))]
    rings = [np.concatenate([side, side[-2:0:-1] * (-1.0, 1.0)]) for side in half]
    count, size = len(rings), len(rings[0])
    position = np.concatenate(
        [np.column_stack([np.full(size, x_m), ring]) for x_m, ring in zip(profile.x_m, rings, strict=True)]
    )
    k, j = np.meshgrid(np.arange(count - 1), np.arange(size), indexing="ij")
    a, b = k * size + j, k * size + (j + 1) % size
    wall = np.concatenate([np.stack([a, a + size, b], axis=-1), np.stack([b, a + size, b + size], axis=-1)], axis=0)
    faces = np.concatenate([wall.reshape(-1, 3), _cap(size), _cap(size)[:, ::-1] + (count - 1) * size])
    return position, faces if _volume(position, faces) > 0 else faces[:, ::-1]


def _half_ring(profile: Profile, k: int, detail: int) -> NDArray[np.float64]:
    """(R, 2) y and z from the middle of the floor up the left side to the middle of the roof."""
    half, roof_half = profile.half_width_m[k], profile.roof_half_width_m[k]
    floor, belt, roof, cabin = profile.floor_m[k], profile.belt_m[k], profile.roof_m[k], profile.cabin[k]
    widths = {0.06: 0.965, 0.30: 0.99, 0.52: 1.0, 0.72: 0.995, 0.88: 0.985}
    points = [(0.0, floor), (half * 0.90, floor)]
    points += [(half * widths[share], floor + (belt - floor) * share) for share in _SIDE_ROWS[detail]]
    points.append((half * 0.965, belt))
    edge = belt + (roof - belt) * (1 - 0.10 * cabin)
    for share in _CABIN_ROWS[detail]:
        bulge = 0.02 * cabin * np.sin(share * np.pi)
        points.append((half * 0.955 * (1 - share) + roof_half * share + bulge, belt + (edge - belt) * share))
    for share in _ROOF_ROWS[detail][:-1]:
        angle = share * np.pi / 2
        points.append((roof_half * np.cos(angle) ** 0.75, edge + (roof - edge) * np.sin(angle)))
    points.append((0.0, roof))
    return np.array(points)


def _cap(size: int) -> NDArray[np.int64]:
    """Triangles across one ring whose points 0 and size / 2 lie in the middle."""
    faces: list[list[int]] = []
    for j in range(size // 2):
        left, right = (j, j + 1), ((size - j) % size, size - j - 1)
        if left[0] != right[0]:
            faces.append([left[0], left[1], right[0]])
        if left[1] != right[1]:
            faces.append([left[1], right[1], right[0]])
    return np.array(faces)


def _volume(position: NDArray[np.float64], faces: NDArray[np.integer]) -> float:
    a, b, c = position[faces].transpose(1, 0, 2)
    return float(np.sum(a * np.cross(b, c)) / 6)


def _face_normals(position: NDArray[np.float64], faces: NDArray[np.integer]) -> NDArray[np.float64]:
    a, b, c = position[faces].transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    return normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)


def _pictures_of(shape: CarShape, center: NDArray[np.float64], normal: NDArray[np.float64]) -> NDArray[np.int64]:
    """(F,) the picture of each face: 0 side, 1 front, 2 rear, 3 top, 4 none (the floor)."""
    along = 0.5 - center[:, 0] / shape.length_m
    rear_window = (along > shape.roof_end) & (along < shape.deck_start) & (center[:, 2] > shape.deck_m - 0.03)
    picture = np.full(len(center), 3)
    picture[np.abs(normal[:, 1]) > 0.55] = 0
    picture[(normal[:, 0] > 0.55) & (along < 0.2)] = 1
    picture[(normal[:, 0] < -0.55) & (along > 0.8) & ~rear_window] = 2
    if shape.steep_tail:
        picture[(normal[:, 0] < -0.45) & (along > 0.8)] = 2
    picture[(picture == 3) & (along < 0.05)] = 1
    picture[(normal[:, 2] < -0.7) & (center[:, 2] < shape.belt_m * 0.6)] = 4
    return picture


def _projected(shape: CarShape, position: NDArray[np.float64], picture: int) -> NDArray[np.float64]:
    """(V, 2) texture places: the position seen along an axis."""
    x, y = 0.5 + position[:, 0] / shape.length_m, 0.5 + position[:, 1] / shape.width_m
    z = 1 - position[:, 2] / shape.height_m
    return np.column_stack({0: (x, z), 1: (y, z), 2: (1 - y, z), 3: (x, 1 - y)}[picture])


def _fittings(shape: CarShape, detail: int) -> list[Mesh]:
    """Mirrors, and the pickup's bed or the roof's rails."""
    s = shape
    fittings: list[Mesh] = []
    mirror_x = s.x_at(s.hood_end + 0.35 * (s.roof_start - s.hood_end))
    painted = Surface((1.0, 1.0, 1.0), Material.PAINT, paint=1.0, rough=0.3)
    for sign in (-1, 1):
        ends = sorted((sign * (s.width_m / 2 - 0.06), sign * (s.width_m / 2 + _MIRROR_M)))
        low, high = (mirror_x - 0.06, ends[0], s.belt_m + 0.02), (mirror_x + 0.08, ends[1], s.belt_m + 0.17)
        fittings.append(box(low, high, painted))
    if s.body == "pickup":
        bed = Surface((0.03, 0.03, 0.03), Material.PLASTIC, rough=0.9)
        low = (-s.length_m * 0.485, -s.width_m * 0.40, s.deck_m - 0.02)
        fittings.append(box(low, (s.x_at(s.deck_start) - 0.03, s.width_m * 0.40, s.deck_m + 0.035), bed))
    elif s.style in ("suv", "wagon") and detail < 2:
        rail = Surface((0.05, 0.05, 0.055), Material.METAL, metal=0.5, rough=0.4)
        start, end = s.x_at(s.roof_end - 0.05), s.x_at(s.roof_start + 0.06)
        for sign in (-1, 1):
            y = sign * s.width_m * 0.355
            low = (start, y - 0.02, s.height_m * 0.93)
            fittings.append(box(low, (end, y + 0.02, s.height_m * 0.995), rail))
    return fittings


def _wheels(shape: CarShape, rim_layer: int, detail: int) -> list[Mesh]:
    width_m = 0.26 if shape.body == "pickup" else 0.22
    one = wheel(shape.wheel_radius_m, width_m, rim_layer, sides=_WHEEL_SIDES[detail])
    side_m = shape.width_m / 2 - width_m / 2 + 0.005
    return [
        one.placed((x_m, sign * side_m, shape.wheel_radius_m))
        for x_m in (shape.front_axle_m, shape.rear_axle_m)
        for sign in (-1, 1)
    ]
