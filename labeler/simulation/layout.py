"""Where everything in a simulated town stands: streets, lanes, junctions, signals, parking slots, buildings, trees.

The world's frame has x to the east, y to the north and z up, in metres; streets are flat at z = 0, sidewalks lie
``KERB_HEIGHT_M`` above them. Angles are in radians, counter-clockwise from east. Traffic keeps to the right.

Streets run along the lines of a grid whose spacing varies. Junction (i, j) is the crossing of the i-th street from the
west with the j-th from the south, and (0, 0) is the origin. Each street has two lanes each way; beside them lie bays
for parked cars, cut into the sidewalk so that they never narrow a lane and end before each junction. A ring of
buildings stands outside of the outermost streets. Nothing here knows how anything looks: this module holds numbers
only, all of which follow from a seed.
"""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from labeler.simulation.blocks import Block, Building, Furniture, Rectangle, Side, Tree, plan_block
from labeler.simulation.dimensions import (
    BAY_DEPTH_M,
    BAY_START_M,
    BORDER_DEPTH_M,
    CROSSING_START_M,
    CROSSING_WIDTH_M,
    HALF_CARRIAGEWAY_M,
    LANE_WIDTH_M,
    LANES_EACH_WAY,
    SLOT_LENGTH_M,
    SLOT_WIDTH_M,
    STOP_LINE_M,
)
from labeler.simulation.errors import SimulationError
from labeler.simulation.towns import TownStyle, town_style

JunctionId = tuple[int, int]
Approach = Literal[0, 1, 2, 3]
"""The side of a junction by where its traffic heads: 0 east, 1 north, 2 west, 3 south (a quarter turn each)."""
_STEP: dict[Approach, tuple[int, int]] = {0: (1, 0), 1: (0, 1), 2: (-1, 0), 3: (0, -1)}
_APPROACHES: tuple[Approach, ...] = (0, 1, 2, 3)


@dataclass(frozen=True)
class Junction:
    """Where streets meet. ``approaches`` lists those by which traffic comes in; a junction with three or four of them
    has signals and crossings, one with two is a bend."""

    junction_id: JunctionId
    x_m: float
    y_m: float
    approaches: tuple[Approach, ...]

    @property
    def signalised(self) -> bool:
        return len(self.approaches) >= 3

    @property
    def name(self) -> str:
        """Such as ``J2_0``; unique, fit for a SUMO node."""
        return f"J{self.junction_id[0]}_{self.junction_id[1]}"


@dataclass(frozen=True)
class Edge:
    """One direction of the street between two neighbouring junctions. It enters ``end`` by ``approach``."""

    start: Junction
    end: Junction
    approach: Approach

    @property
    def name(self) -> str:
        """Such as ``J0_0to1_0``; unique, fit for a SUMO edge."""
        return f"{self.start.name}to{self.end.junction_id[0]}_{self.end.junction_id[1]}"

    @property
    def heading_rad(self) -> float:
        return heading_of(self.approach)

    @property
    def length_m(self) -> float:
        """From centre to centre of its junctions."""
        return math.hypot(self.end.x_m - self.start.x_m, self.end.y_m - self.start.y_m)

    def lane_center_m(self, lane: int) -> NDArray[np.float64]:
        """(2, 2) first and last point of a lane's centre line between its two stop lines. Lane 0 is the rightmost,
        as in SUMO."""
        if not 0 <= lane < LANES_EACH_WAY:
            raise ValueError(f"lane {lane} does not exist: there are {LANES_EACH_WAY}")
        offset_m = (LANES_EACH_WAY - lane - 0.5) * LANE_WIDTH_M
        return np.stack([self.point_m(STOP_LINE_M, offset_m), self.point_m(self.length_m - STOP_LINE_M, offset_m)])

    def point_m(self, along_m: float, right_m: float) -> NDArray[np.float64]:
        """(2,) the point ``along_m`` from the start's centre and ``right_m`` to the right of the street's centre."""
        cos, sin = _direction(self.approach)
        return np.array(
            [self.start.x_m + cos * along_m + sin * right_m, self.start.y_m + sin * along_m - cos * right_m]
        )


@dataclass(frozen=True)
class Crossing:
    """A zebra crossing over the whole carriageway on the arm of a junction that ``approach`` comes in by."""

    junction_id: JunctionId
    approach: Approach
    area: Rectangle


@dataclass(frozen=True)
class Signal:
    """The signal of one approach: a pole on the far right corner of the junction with a head at eye level and another
    on an arm above the lanes. Both heads show the same lamp and face the traffic that comes in.

    ``x_m, y_m`` is the pole's foot, on the sidewalk. ``heading_rad`` is the heading of the traffic it serves; the
    lamps face the opposite way. ``heads_m`` holds each head's (x, y) and the height of its green lamp; yellow and red
    stand ``LAMP_SPACING_M`` and twice that above it. ``stop_line_m`` is the middle of the approach's stop line."""

    junction_id: JunctionId
    approach: Approach
    x_m: float
    y_m: float
    heading_rad: float
    heads_m: tuple[tuple[float, float, float], ...]
    stop_line_m: tuple[float, float]


_ARM_M = 5.4
_ARM_GREEN_M = 5.0
_POLE_GREEN_M = 2.7
_CORNER_M = 0.8


@dataclass(frozen=True)
class ParkingSlot:
    """Room for one parked vehicle, parallel to the kerb. ``yaw_rad`` is the heading of the lane beside it. The slot is
    ``SLOT_LENGTH_M`` by ``SLOT_WIDTH_M``, in a bay outside of every lane; z is 0."""

    slot_id: int
    x_m: float
    y_m: float
    yaw_rad: float
    length_m: float = SLOT_LENGTH_M
    width_m: float = SLOT_WIDTH_M


@dataclass(frozen=True)
class Lamp:
    """A street lamp. Its arm points along ``yaw_rad``, over the street."""

    x_m: float
    y_m: float
    yaw_rad: float


@dataclass(frozen=True)
class TownLayout:
    """A town's numbers; see the module's text for frames and units. Use ``TownLayout.generate``.

    ``x_m`` and ``y_m`` are the centre lines of the streets that run north-south and east-west. ``bays`` are the parking
    bays: rectangles of asphalt at z = 0 beyond the carriageway's edge."""

    seed: int
    style: TownStyle
    x_m: NDArray[np.float64]
    y_m: NDArray[np.float64]
    junctions: dict[JunctionId, Junction]
    edges: tuple[Edge, ...]
    crossings: tuple[Crossing, ...]
    signals: tuple[Signal, ...]
    bays: tuple[Rectangle, ...]
    slots: tuple[ParkingSlot, ...]
    blocks: tuple[Block, ...]
    buildings: tuple[Building, ...]
    trees: tuple[Tree, ...]
    lamps: tuple[Lamp, ...]
    furniture: tuple[Furniture, ...]

    @classmethod
    def generate(cls, seed: int, *, town: str = "grid", blocks: tuple[int, int] | None = None) -> "TownLayout":
        """The town that follows from ``seed`` (0 or more). ``town`` names a style (see ``towns.TOWNS``); ``blocks``
        overrides how many blocks it has along x and along y. SimulationError on values that make no town."""
        style = town_style(town)
        columns, rows = blocks or style.blocks
        if seed < 0 or columns < 1 or rows < 1:
            raise SimulationError(
                f"a town needs a seed of 0 or more and at least 1 x 1 blocks, not seed {seed} with {columns} x {rows}"
            )
        rng = np.random.default_rng([seed, 1])
        x_m = _street_lines(rng, style, columns)
        y_m = _street_lines(rng, style, rows)
        junctions = _junctions(x_m, y_m)
        edges = _edges(junctions)
        controlled: list[tuple[Junction, Approach]] = [
            (j, approach) for j in junctions.values() if j.signalised for approach in j.approaches
        ]
        bays = [_bay(edge) for edge in edges]
        slots = _slots(rng, edges, style.parking_share)
        planned = [plan_block(rng, block, style) for block in _blocks(x_m, y_m, bays)]
        return cls(
            seed=seed,
            style=style,
            x_m=x_m,
            y_m=y_m,
            junctions=junctions,
            edges=edges,
            crossings=tuple(_crossing(junction, approach) for junction, approach in controlled),
            signals=tuple(_signal(junction, approach) for junction, approach in controlled),
            bays=tuple(bays),
            slots=slots,
            blocks=tuple(plan.block for plan in planned),
            buildings=tuple(building for plan in planned for building in plan.buildings),
            trees=tuple(tree for plan in planned for tree in plan.trees) + _street_trees(rng, edges, style),
            lamps=_lamps(edges),
            furniture=tuple(item for plan in planned for item in plan.furniture),
        )

    @property
    def bounds(self) -> Rectangle:
        """The whole town with its ring of buildings."""
        margin_m = HALF_CARRIAGEWAY_M + BORDER_DEPTH_M
        return Rectangle(
            float(self.x_m[0]) - margin_m, float(self.y_m[0]) - margin_m,
            float(self.x_m[-1]) + margin_m, float(self.y_m[-1]) + margin_m,
        )  # fmt: skip

    def on_carriageway(self, points_m: NDArray[np.floating]) -> NDArray[np.bool_]:
        """(N,) which of (N, 2) points lie on a street between its kerbs, parking bays left out."""
        x_m, y_m = points_m[:, 0], points_m[:, 1]
        reach_m = HALF_CARRIAGEWAY_M
        inside_x = (x_m >= self.x_m[0] - reach_m) & (x_m <= self.x_m[-1] + reach_m)
        inside_y = (y_m >= self.y_m[0] - reach_m) & (y_m <= self.y_m[-1] + reach_m)
        near_x = np.abs(x_m[:, None] - self.x_m[None]).min(axis=1) <= reach_m
        near_y = np.abs(y_m[:, None] - self.y_m[None]).min(axis=1) <= reach_m
        return inside_x & inside_y & (near_x | near_y)


def heading_of(approach: Approach) -> float:
    """The heading in radians of the traffic of an approach, from -pi (left out) to pi."""
    return (0.0, math.pi / 2, math.pi, -math.pi / 2)[approach]


def _direction(approach: Approach) -> tuple[int, int]:
    return _STEP[approach]


def _street_lines(rng: np.random.Generator, style: TownStyle, count: int) -> NDArray[np.float64]:
    """(count + 1,) centre lines; the first at 0, whole metres."""
    return np.concatenate([[0.0], np.cumsum(np.round(rng.uniform(*style.block_m, size=count)))])


def _junctions(x_m: NDArray[np.float64], y_m: NDArray[np.float64]) -> dict[JunctionId, Junction]:
    def approaches(i: int, j: int) -> tuple[Approach, ...]:
        return tuple(a for a in _APPROACHES if 0 <= i - _STEP[a][0] < len(x_m) and 0 <= j - _STEP[a][1] < len(y_m))

    return {
        (i, j): Junction((i, j), float(x_m[i]), float(y_m[j]), approaches(i, j))
        for i in range(len(x_m))
        for j in range(len(y_m))
    }


def _edges(junctions: dict[JunctionId, Junction]) -> tuple[Edge, ...]:
    return tuple(
        Edge(junctions[i - _STEP[approach][0], j - _STEP[approach][1]], end, approach)
        for (i, j), end in junctions.items()
        for approach in end.approaches
    )


def _crossing(junction: Junction, approach: Approach) -> Crossing:
    near_m, far_m, half_m = CROSSING_START_M, CROSSING_START_M + CROSSING_WIDTH_M, HALF_CARRIAGEWAY_M
    return Crossing(
        junction.junction_id, approach, _approach_rectangle(junction, approach, -far_m, -near_m, -half_m, half_m)
    )


def _approach_rectangle(
    junction: Junction, approach: Approach, along_0_m: float, along_1_m: float, right_0_m: float, right_1_m: float
) -> Rectangle:
    """A rectangle given along and to the right of an approach's heading, seen from the junction's centre."""
    cos, sin = _direction(approach)
    xs = [junction.x_m + cos * a + sin * r for a in (along_0_m, along_1_m) for r in (right_0_m, right_1_m)]
    ys = [junction.y_m + sin * a - cos * r for a in (along_0_m, along_1_m) for r in (right_0_m, right_1_m)]
    return Rectangle(min(xs), min(ys), max(xs), max(ys))


def _signal(junction: Junction, approach: Approach) -> Signal:
    cos, sin = _direction(approach)

    def world(along_m: float, right_m: float) -> tuple[float, float]:
        return junction.x_m + cos * along_m + sin * right_m, junction.y_m + sin * along_m - cos * right_m

    corner_m = HALF_CARRIAGEWAY_M + _CORNER_M
    pole_m = world(corner_m, corner_m)
    return Signal(
        junction_id=junction.junction_id,
        approach=approach,
        x_m=pole_m[0],
        y_m=pole_m[1],
        heading_rad=heading_of(approach),
        heads_m=((*pole_m, _POLE_GREEN_M), (*world(corner_m, corner_m - _ARM_M), _ARM_GREEN_M)),
        stop_line_m=world(-STOP_LINE_M, LANES_EACH_WAY * LANE_WIDTH_M / 2),
    )


def _bay(edge: Edge) -> Rectangle:
    """The parking bay at the right side of an edge."""
    corner_a = edge.point_m(BAY_START_M, HALF_CARRIAGEWAY_M)
    corner_b = edge.point_m(edge.length_m - BAY_START_M, HALF_CARRIAGEWAY_M + BAY_DEPTH_M)
    low, high = np.minimum(corner_a, corner_b), np.maximum(corner_a, corner_b)
    return Rectangle(float(low[0]), float(low[1]), float(high[0]), float(high[1]))


def _slots(rng: np.random.Generator, edges: tuple[Edge, ...], share: float) -> tuple[ParkingSlot, ...]:
    slots: list[ParkingSlot] = []
    for edge in edges:
        free_m = edge.length_m - 2 * BAY_START_M
        count = int(free_m // SLOT_LENGTH_M)
        start_m = BAY_START_M + (free_m - count * SLOT_LENGTH_M) / 2
        for k in np.flatnonzero(rng.random(count) < share):
            x_m, y_m = edge.point_m(start_m + (float(k) + 0.5) * SLOT_LENGTH_M, HALF_CARRIAGEWAY_M + BAY_DEPTH_M / 2)
            slots.append(ParkingSlot(len(slots), float(x_m), float(y_m), edge.heading_rad))
    return tuple(slots)


def _blocks(x_m: NDArray[np.float64], y_m: NDArray[np.float64], bays: list[Rectangle]) -> list[Block]:
    """Between every four streets one block, and four long ones around the town."""
    half_m, depth_m = HALF_CARRIAGEWAY_M, BORDER_DEPTH_M
    west_m, south_m, east_m, north_m = float(x_m[0]), float(y_m[0]), float(x_m[-1]), float(y_m[-1])
    all_around: frozenset[Side] = frozenset({"south", "east", "north", "west"})
    areas: list[tuple[Rectangle, frozenset[Side]]] = [
        (
            Rectangle(float(x0) + half_m, float(y0) + half_m, float(x1) - half_m, float(y1) - half_m),
            all_around,
        )
        for x0, x1 in pairwise(x_m)
        for y0, y1 in pairwise(y_m)
    ]
    outer_west_m, outer_east_m = west_m - half_m - depth_m, east_m + half_m + depth_m
    ring: list[tuple[Rectangle, frozenset[Side]]] = [
        (Rectangle(outer_west_m, south_m - half_m - depth_m, outer_east_m, south_m - half_m), frozenset({"north"})),
        (Rectangle(outer_west_m, north_m + half_m, outer_east_m, north_m + half_m + depth_m), frozenset({"south"})),
        (Rectangle(outer_west_m, south_m - half_m, west_m - half_m, north_m + half_m), frozenset({"east"})),
        (Rectangle(east_m + half_m, south_m - half_m, outer_east_m, north_m + half_m), frozenset({"west"})),
    ]
    return [Block(area, streets, tuple(bay for bay in bays if bay.overlaps(area))) for area, streets in areas + ring]


def _lamps(edges: tuple[Edge, ...]) -> tuple[Lamp, ...]:
    """Along each side of each street, on the sidewalk behind the bays and never where an arm of a signal hangs."""
    lamps: list[Lamp] = []
    for edge in edges:
        count = max(1, round((edge.length_m - 2 * BAY_START_M) / 26.0))
        for along_m in np.linspace(BAY_START_M, edge.length_m - BAY_START_M, count + 1):
            x_m, y_m = edge.point_m(float(along_m), HALF_CARRIAGEWAY_M + BAY_DEPTH_M + 0.55)
            lamps.append(Lamp(float(x_m), float(y_m), edge.heading_rad + math.pi / 2))
    return tuple(lamps)


def _street_trees(rng: np.random.Generator, edges: tuple[Edge, ...], style: TownStyle) -> tuple[Tree, ...]:
    """A row of trees behind the bays of each side of a street, between the lamps."""
    trees: list[Tree] = []
    for edge in edges:
        for along_m in np.arange(BAY_START_M + 4.5, edge.length_m - BAY_START_M - 3.0, style.tree_spacing_m):
            if rng.random() >= style.tree_share:
                continue
            x_m, y_m = edge.point_m(float(along_m + rng.uniform(-0.8, 0.8)), HALF_CARRIAGEWAY_M + BAY_DEPTH_M + 0.9)
            trees.append(
                Tree(float(x_m), float(y_m), float(rng.uniform(5.0, 8.5)), int(rng.integers(1 << 16)), "street")
            )
    return tuple(trees)
