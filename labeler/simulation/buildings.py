"""The meshes of buildings: walls with facades, flat roofs with parapets or gables, awnings and balconies."""

import numpy as np
from numpy.typing import NDArray

from labeler.simulation.blocks import GROUND_STOREY_M, STOREY_M, Building, Rectangle
from labeler.simulation.dimensions import KERB_HEIGHT_M
from labeler.simulation.facades import BAY_M, BAYS, Facade
from labeler.simulation.materials import Material, Shading
from labeler.simulation.meshes import Mesh, Surface, box, join, quad
from labeler.simulation.textures import rgb_of

_PARAPET_M = 0.6
_EAVES_M = 0.45
_TILES = ((0.30, 0.09, 0.05), (0.16, 0.07, 0.05), (0.09, 0.09, 0.10))


def building_mesh(building: Building, facades: dict[str, list[Facade]]) -> Mesh:
    """One building in the world's frame, standing on the sidewalk's height."""
    rng = np.random.default_rng([building.look, 3])
    kinds = facades[building.facade]
    facade = kinds[int(rng.integers(len(kinds)))]
    tint = rgb_of(rng.uniform(0.85, 1.08, size=3) * rng.uniform(0.85, 1.05))
    shops = building.storeys > 1 and building.roof == "flat" and bool(rng.random() < 0.7)
    base_m, top_m = KERB_HEIGHT_M, KERB_HEIGHT_M + building.height_m
    ground_m = base_m + (GROUND_STOREY_M if building.storeys > 1 else STOREY_M)
    parts: list[Mesh] = []
    for start, end in _walls(building.area):
        length_m = float(np.linalg.norm(end - start))
        bays = max(1, round(length_m / BAY_M)) / BAYS
        parts.append(_wall(start, end, base_m, ground_m, facade.shops if shops else facade.flats, (bays, 1.0), tint))
        if building.storeys > 1:
            storeys = (building.storeys - 1) / BAYS
            parts.append(_wall(start, end, ground_m, top_m, facade.upper, (bays, storeys), tint))
    parts += _gable(building, top_m, rng) if building.roof == "gable" else _flat_roof(building, top_m, rng)
    if shops and rng.random() < 0.6:
        parts += _awnings(building, rng)
    elif building.facade == "plaster" and building.storeys > 2:
        parts += _balconies(building)
    return join(parts)


def _walls(area: Rectangle) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Start and end of each wall, counter-clockwise from above, so that each faces outwards."""
    corners = np.array([
        (area.x0_m, area.y0_m), (area.x1_m, area.y0_m), (area.x1_m, area.y1_m), (area.x0_m, area.y1_m),
    ])  # fmt: skip
    return [(corners[k], corners[(k + 1) % 4]) for k in range(4)]


def _wall(
    start: NDArray[np.float64], end: NDArray[np.float64], low_m: float, high_m: float, layer: int,
    repeats: tuple[float, float], tint: tuple[float, float, float],
) -> Mesh:  # fmt: skip
    corners = [(*start, low_m), (*end, low_m), (*end, high_m), (*start, high_m)]
    across, up = repeats
    uv = [(0.0, up), (across, up), (across, 0.0), (0.0, 0.0)]
    return quad(corners, Surface(tint, Material.WALL, rough=0.85, layer=layer, shading=Shading.FACADE), uv=uv)


def _flat_roof(building: Building, top_m: float, rng: np.random.Generator) -> list[Mesh]:
    a = building.area
    stone = Surface(rgb_of(rng.uniform(0.16, 0.34) * np.ones(3)), Material.WALL, rough=0.9)
    parts = [box((a.x0_m - 0.2, a.y0_m - 0.2, top_m - 0.1), (a.x1_m + 0.2, a.y1_m + 0.2, top_m + _PARAPET_M), stone)]
    metal = Surface((0.4, 0.41, 0.42), Material.METAL, rough=0.5, metal=0.3)
    for _ in range(int(rng.integers(1, 4))):
        side_m, height_m = float(rng.uniform(1.2, 3.0)), float(rng.uniform(0.9, 2.4))
        x_m = float(rng.uniform(a.x0_m + 2.0, max(a.x0_m + 2.1, a.x1_m - 2.0 - side_m)))
        y_m = float(rng.uniform(a.y0_m + 2.0, max(a.y0_m + 2.1, a.y1_m - 2.0 - side_m)))
        low_m = top_m + _PARAPET_M
        parts.append(box((x_m, y_m, low_m), (x_m + side_m, y_m + side_m, low_m + height_m), metal))
    return parts


def _gable(building: Building, top_m: float, rng: np.random.Generator) -> list[Mesh]:
    """A ridge along the longer side, with tiles and a chimney."""
    a = building.area
    tiles = Surface(_TILES[int(rng.integers(len(_TILES)))], Material.WALL, rough=0.9)
    plaster = Surface((0.55, 0.52, 0.46), Material.WALL, rough=0.9)
    along_x = a.width_m >= a.depth_m
    x0, x1, y0, y1 = a.x0_m - _EAVES_M, a.x1_m + _EAVES_M, a.y0_m - _EAVES_M, a.y1_m + _EAVES_M
    ridge_m = top_m + 0.42 * (a.depth_m if along_x else a.width_m)
    if along_x:
        middle = (y0 + y1) / 2
        ends = [(x0, middle, ridge_m), (x1, middle, ridge_m)]
        slopes = [
            [(x0, y0, top_m), (x1, y0, top_m), ends[1], ends[0]],
            [(x1, y1, top_m), (x0, y1, top_m), ends[0], ends[1]],
        ]
        gables = [[(x0, y1, top_m), (x0, y0, top_m), ends[0]], [(x1, y0, top_m), (x1, y1, top_m), ends[1]]]
    else:
        middle = (x0 + x1) / 2
        ends = [(middle, y0, ridge_m), (middle, y1, ridge_m)]
        slopes = [
            [(x0, y1, top_m), (x0, y0, top_m), ends[0], ends[1]],
            [(x1, y0, top_m), (x1, y1, top_m), ends[1], ends[0]],
        ]
        gables = [[(x0, y0, top_m), (x1, y0, top_m), ends[0]], [(x1, y1, top_m), (x0, y1, top_m), ends[1]]]
    parts = [quad(slope, tiles) for slope in slopes]
    parts += [quad([*gable, gable[2]], plaster) for gable in gables]
    parts.append(quad([(x0, y0, top_m), (x0, y1, top_m), (x1, y1, top_m), (x1, y0, top_m)], plaster))
    x_m, y_m = a.x0_m + 0.3 * a.width_m, a.y0_m + 0.4 * a.depth_m
    brick = Surface((0.22, 0.09, 0.06), Material.WALL, rough=0.9)
    parts.append(box((x_m, y_m, top_m + 0.5), (x_m + 0.7, y_m + 0.7, ridge_m + 0.7), brick))
    return parts


def _front_boxes(
    building: Building, along_m: tuple[float, float], z_m: tuple[float, float], out_m: float, surface: Surface
) -> Mesh:
    """A box that stands ``out_m`` out of the front wall between two places along it."""
    a = building.area
    if building.front in ("south", "north"):
        wall_m, sign = (a.y0_m, -1) if building.front == "south" else (a.y1_m, 1)
        low, high = sorted((wall_m, wall_m + sign * out_m))
        return box((a.x0_m + along_m[0], low, z_m[0]), (a.x0_m + along_m[1], high, z_m[1]), surface)
    wall_m, sign = (a.x0_m, -1) if building.front == "west" else (a.x1_m, 1)
    low, high = sorted((wall_m, wall_m + sign * out_m))
    return box((low, a.y0_m + along_m[0], z_m[0]), (high, a.y0_m + along_m[1], z_m[1]), surface)


def _front_m(building: Building) -> float:
    return building.area.width_m if building.front in ("south", "north") else building.area.depth_m


def _awnings(building: Building, rng: np.random.Generator) -> list[Mesh]:
    cloth = Surface(rgb_of(rng.uniform(0.02, 0.5, size=3)), rough=0.9)
    low_m = KERB_HEIGHT_M + 2.75
    return [
        _front_boxes(building, (float(start), float(start) + 3.0), (low_m, low_m + 0.16), 1.1, cloth)
        for start in np.arange(0.6, _front_m(building) - 3.4, 4.4)
        if rng.random() < 0.7
    ]


def _balconies(building: Building) -> list[Mesh]:
    slab = Surface((0.5, 0.5, 0.49), Material.WALL, rough=0.8)
    rail = Surface((0.06, 0.06, 0.065), Material.METAL, rough=0.5)
    parts: list[Mesh] = []
    for storey in range(1, building.storeys):
        floor_m = KERB_HEIGHT_M + GROUND_STOREY_M + (storey - 1) * STOREY_M
        for start in np.arange(1.0, _front_m(building) - 3.2, 2 * BAY_M):
            along_m = (float(start), float(start) + 2.6)
            parts.append(_front_boxes(building, along_m, (floor_m, floor_m + 0.12), 1.0, slab))
            parts.append(_front_boxes(building, along_m, (floor_m + 0.12, floor_m + 1.0), 0.95, rail))
    return parts
