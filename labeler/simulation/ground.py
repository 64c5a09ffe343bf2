"""The ground of a town: carriageways, parking bays, markings, kerbs, sidewalks and lawns, as flat pieces.

Markings lie ``_MARKING_M`` above the asphalt, which no picture shows and keeps them visible at any distance.
Texture places of asphalt are (metres to the side of the street's centre line, metres along); a side of
``NO_STREET_M`` means that no wheels have worn the place.
"""

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from labeler.simulation.blocks import Block, Rectangle, sidewalk_of
from labeler.simulation.dimensions import (
    BAY_DEPTH_M,
    BAY_START_M,
    HALF_CARRIAGEWAY_M,
    KERB_HEIGHT_M,
    LANE_WIDTH_M,
    LANES_EACH_WAY,
    STOP_LINE_M,
    STOP_LINE_WIDTH_M,
)
from labeler.simulation.layout import Crossing, Edge, ParkingSlot, TownLayout
from labeler.simulation.materials import Material, Shading
from labeler.simulation.meshes import Mesh, Surface, build_mesh, join, quad
from labeler.simulation.towns import TownStyle

NO_STREET_M = 99.0
_MARKING_M = 0.006
_LINE_M = 0.14
_KERBSTONE_M = 0.16
_ASPHALT = Surface((0.085, 0.085, 0.088), Material.ASPHALT, rough=0.9, shading=Shading.ASPHALT)
_BAY = Surface((0.105, 0.10, 0.098), Material.ASPHALT, rough=0.9, shading=Shading.ASPHALT)
_WHITE = Surface((0.62, 0.62, 0.61), Material.MARKING, rough=0.8, shading=Shading.MARKING)
_YELLOW = Surface((0.58, 0.40, 0.07), Material.MARKING, rough=0.8, shading=Shading.MARKING)
_PAVING = Surface((0.33, 0.32, 0.30), Material.PAVING, rough=0.9, shading=Shading.PAVING)
_KERB = Surface((0.40, 0.39, 0.38), Material.PAVING, rough=0.9, shading=Shading.MARKING)
_LAWN = Surface((0.085, 0.14, 0.04), Material.GRASS, rough=0.95, shading=Shading.GRASS)


def ground_pieces(layout: TownLayout) -> list[Mesh]:
    """All of a town's ground, in pieces that can be drawn or left out one by one. z = 0 is asphalt."""
    pieces = [_outskirts(layout), *_junctions(layout)]
    for edge in layout.edges:
        if edge.approach in (0, 1):
            pieces.append(_carriageway(edge))
        pieces.append(join(_edge_markings(edge)))
    pieces += [_flat(bay, 0.0, _BAY, uv=[(NO_STREET_M, 0.0)] * 4) for bay in layout.bays]
    pieces += [_slot_corner(slot) for slot in layout.slots]
    pieces += [join(_zebra(crossing)) for crossing in layout.crossings]
    pieces += [_block(block, layout.style) for block in layout.blocks]
    return pieces


def _flat(area: Rectangle, z_m: float, surface: Surface, *, uv: ArrayLike | None = None) -> Mesh:
    x0, y0, x1, y1 = area.x0_m, area.y0_m, area.x1_m, area.y1_m
    corners = [(x0, y0, z_m), (x1, y0, z_m), (x1, y1, z_m), (x0, y1, z_m)]
    return quad(corners, surface, uv=uv)


def _outskirts(layout: TownLayout) -> Mesh:
    """Lawn around the town up to the horizon, in four pieces."""
    near, far_m = layout.bounds, 900.0
    z_m = KERB_HEIGHT_M
    sides = [
        Rectangle(near.x0_m - far_m, near.y0_m - far_m, near.x1_m + far_m, near.y0_m),
        Rectangle(near.x0_m - far_m, near.y1_m, near.x1_m + far_m, near.y1_m + far_m),
        Rectangle(near.x0_m - far_m, near.y0_m, near.x0_m, near.y1_m),
        Rectangle(near.x1_m, near.y0_m, near.x1_m + far_m, near.y1_m),
    ]
    return join([_flat(side, z_m, _LAWN) for side in sides])


def _junctions(layout: TownLayout) -> list[Mesh]:
    half_m = HALF_CARRIAGEWAY_M
    return [
        _flat(
            Rectangle(j.x_m - half_m, j.y_m - half_m, j.x_m + half_m, j.y_m + half_m),
            0.0,
            _ASPHALT,
            uv=[(NO_STREET_M, 0.0)] * 4,
        )
        for j in layout.junctions.values()
    ]


def _strip(
    edge: Edge, along_m: tuple[float, float], right_m: tuple[float, float], surface: Surface, *, z_m: float = _MARKING_M
) -> Mesh:
    """A rectangle given along and to the right of an edge."""
    places = [(along_m[0], right_m[1]), (along_m[1], right_m[1]), (along_m[1], right_m[0]), (along_m[0], right_m[0])]
    corners = [(*edge.point_m(along, right), z_m) for along, right in places]
    return quad(corners, surface, uv=[(right, along) for along, right in places])


def _carriageway(edge: Edge) -> Mesh:
    """Both directions of a street between its junctions' squares."""
    half_m = HALF_CARRIAGEWAY_M
    return _strip(edge, (half_m, edge.length_m - half_m), (-half_m, half_m), _ASPHALT, z_m=0.0)


def _edge_markings(edge: Edge) -> list[Mesh]:
    """Stop line, centre line, dashes between the lanes, the bay's edge and arrows, for one direction."""
    controlled = edge.end.signalised
    start_m = STOP_LINE_M if edge.start.signalised else HALF_CARRIAGEWAY_M + 1.0
    end_m = edge.length_m - (STOP_LINE_M if controlled else HALF_CARRIAGEWAY_M + 1.0)
    lane_m = LANE_WIDTH_M
    parts = [_strip(edge, (start_m, end_m), (0.08, 0.08 + _LINE_M), _YELLOW)]
    for dash_m in np.arange(start_m + 1.5, end_m - 4.5, 9.0):
        for lane in range(1, LANES_EACH_WAY):
            side_m = (lane * lane_m - _LINE_M / 2, lane * lane_m + _LINE_M / 2)
            parts.append(_strip(edge, (float(dash_m), float(dash_m) + 3.0), side_m, _WHITE))
    bay_m = (LANES_EACH_WAY * lane_m + 0.02, LANES_EACH_WAY * lane_m + 0.02 + _LINE_M)
    parts.append(_strip(edge, (BAY_START_M, edge.length_m - BAY_START_M), bay_m, _WHITE))
    if controlled:
        stop_m = edge.length_m - STOP_LINE_M
        half_m = STOP_LINE_WIDTH_M / 2
        across_m = (0.1, LANES_EACH_WAY * lane_m)
        parts.append(_strip(edge, (stop_m - half_m, stop_m + half_m), across_m, _WHITE))
        for lane in range(LANES_EACH_WAY):
            parts += _arrow(edge, stop_m - 6.0, (lane + 0.5) * lane_m)
    return parts


def _arrow(edge: Edge, tail_m: float, right_m: float) -> list[Mesh]:
    """An arrow ahead on a lane, 3.4 m long."""
    shaft = _strip(edge, (tail_m, tail_m + 2.2), (right_m - 0.09, right_m + 0.09), _WHITE)
    places = [(tail_m + 2.2, right_m + 0.36), (tail_m + 3.4, right_m), (tail_m + 2.2, right_m - 0.36)]
    corners = [(*edge.point_m(along, right), _MARKING_M) for along, right in places]
    return [shaft, build_mesh(corners, [0.0, 0.0, 1.0], [[0, 1, 2]], _WHITE)]


def _slot_corner(slot: ParkingSlot) -> Mesh:
    """The short lines at the ends of a parking slot."""
    cos, sin = round(np.cos(slot.yaw_rad)), round(np.sin(slot.yaw_rad))
    parts: list[Mesh] = []
    for end in (-1, 1):
        along, half = end * slot.length_m / 2, BAY_DEPTH_M / 2
        places = [(along - 0.05, -half), (along + 0.05, -half), (along + 0.05, half), (along - 0.05, half)]
        corners = [(slot.x_m + cos * a - sin * b, slot.y_m + sin * a + cos * b, _MARKING_M) for a, b in places]
        parts.append(quad(corners, _WHITE))
    return join(parts)


def _zebra(crossing: Crossing) -> list[Mesh]:
    """Bars of half a metre, half a metre apart, along the traffic."""
    area, across_y = crossing.area, crossing.approach in (0, 2)
    low_m, high_m = (area.y0_m, area.y1_m) if across_y else (area.x0_m, area.x1_m)
    bars: list[Mesh] = []
    for start in np.arange(low_m + 0.35, high_m - 0.5, 1.0):
        a, b = float(start), float(start) + 0.5
        bar = Rectangle(area.x0_m, a, area.x1_m, b) if across_y else Rectangle(a, area.y0_m, b, area.y1_m)
        bars.append(_flat(bar, _MARKING_M, _WHITE))
    return bars


def _block(block: Block, style: TownStyle) -> Mesh:
    """A block's sidewalks, lawn and kerbs."""
    area, z_m = block.area, KERB_HEIGHT_M
    inner = area.inset(**dict.fromkeys(sorted(block.streets), BAY_DEPTH_M))
    lawn = sidewalk_of(block, style)
    paved = [*_frame(area, inner, block.bays), *_frame(inner, lawn, ())]
    parts = [_flat(piece, z_m, _PAVING) for piece in paved] + [_flat(lawn, z_m, _LAWN)]
    for line in _kerb_lines(block):
        parts += _kerb(line)
    return join(parts)


def _frame(outer: Rectangle, inner: Rectangle, holes: tuple[Rectangle, ...]) -> list[Rectangle]:
    """What lies between two rectangles, cut where holes reach from the one to the other."""
    south = Rectangle(outer.x0_m, outer.y0_m, outer.x1_m, inner.y0_m)
    north = Rectangle(outer.x0_m, inner.y1_m, outer.x1_m, outer.y1_m)
    west = Rectangle(outer.x0_m, inner.y0_m, inner.x0_m, inner.y1_m)
    east = Rectangle(inner.x1_m, inner.y0_m, outer.x1_m, inner.y1_m)
    pieces: list[Rectangle] = []
    for strip, along_x in ((south, True), (north, True), (west, False), (east, False)):
        if strip.width_m <= 0 or strip.depth_m <= 0:
            continue
        cuts = sorted((h.x0_m, h.x1_m) if along_x else (h.y0_m, h.y1_m) for h in holes if h.overlaps(strip))
        edge_m = strip.x0_m if along_x else strip.y0_m
        for start, end in [*cuts, (strip.x1_m, 0.0) if along_x else (strip.y1_m, 0.0)]:
            if along_x:
                pieces.append(Rectangle(edge_m, strip.y0_m, start, strip.y1_m))
            else:
                pieces.append(Rectangle(strip.x0_m, edge_m, strip.x1_m, start))
            edge_m = end
    return pieces


def _kerb_lines(block: Block) -> list[list[tuple[float, float]]]:
    """The kerb along each side that faces a street, counter-clockwise around the block, in and out of its bays."""
    a, depth_m = block.area, BAY_DEPTH_M
    lines: list[list[tuple[float, float]]] = []
    for side in sorted(block.streets):
        along_x = side in ("south", "north")
        edge_m = {"south": a.y0_m, "north": a.y1_m, "west": a.x0_m, "east": a.x1_m}[side]
        inward_m = depth_m if side in ("south", "west") else -depth_m
        low_m, high_m = (a.x0_m, a.x1_m) if along_x else (a.y0_m, a.y1_m)
        places = [(low_m, edge_m)]
        reach = (edge_m - 0.1, edge_m + 0.1)
        touching = [
            (bay.x0_m, bay.x1_m) if along_x else (bay.y0_m, bay.y1_m)
            for bay in block.bays
            if (bay.y0_m < reach[1] and bay.y1_m > reach[0] if along_x else bay.x0_m < reach[1] and bay.x1_m > reach[0])
        ]
        for start, end in sorted(touching):
            places += [(start, edge_m), (start, edge_m + inward_m), (end, edge_m + inward_m), (end, edge_m)]
        places.append((high_m, edge_m))
        line = places if along_x else [(across, along) for along, across in places]
        lines.append(line if side in ("south", "east") else line[::-1])
    return lines


def _kerb(line: list[tuple[float, float]]) -> list[Mesh]:
    """Upright faces along a line whose right side is the street, and the kerbstones on top."""
    parts: list[Mesh] = []
    top_m = KERB_HEIGHT_M + 0.004
    for (x0, y0), (x1, y1) in pairwise(line):
        length_m = float(np.hypot(x1 - x0, y1 - y0))
        if length_m < 1e-6:
            continue
        parts.append(quad([(x0, y0, 0.0), (x1, y1, 0.0), (x1, y1, top_m), (x0, y0, top_m)], _KERB))
        in_x, in_y = -(y1 - y0) / length_m * _KERBSTONE_M, (x1 - x0) / length_m * _KERBSTONE_M
        stone = [(x0, y0, top_m), (x1, y1, top_m), (x1 + in_x, y1 + in_y, top_m), (x0 + in_x, y0 + in_y, top_m)]
        parts.append(quad(stone, _KERB))
    return parts
