"""What stands on a block: rows of buildings along its streets, gardens and trees between and behind them.

A block is the ground between the kerbs of its streets. From a street inwards come the parking bays, the sidewalk, a
front garden in some towns, and a row of buildings. The rows along the south and north take the corners; those along the
west and east stand between them, so no two buildings can overlap.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from labeler.simulation.dimensions import BAY_DEPTH_M
from labeler.simulation.towns import TownStyle

Side = Literal["south", "east", "north", "west"]
TreeKind = Literal["street", "garden", "bush"]
FurnitureKind = Literal["bench", "bin", "hydrant", "cabinet"]
RoofKind = Literal["flat", "gable"]

STOREY_M = 3.2
GROUND_STOREY_M = 4.2
_DEPTH_M = (10.0, 15.0)
_LEAST_BUILDING_M = 7.0


@dataclass(frozen=True)
class Rectangle:
    """An axis-aligned rectangle on the ground in metres, ``x0 <= x1`` and ``y0 <= y1``."""

    x0_m: float
    y0_m: float
    x1_m: float
    y1_m: float

    def __post_init__(self) -> None:
        if self.x1_m < self.x0_m or self.y1_m < self.y0_m:
            raise ValueError(f"a rectangle's second corner must not lie before its first: {self}")

    @property
    def width_m(self) -> float:
        return self.x1_m - self.x0_m

    @property
    def depth_m(self) -> float:
        return self.y1_m - self.y0_m

    def overlaps(self, other: "Rectangle") -> bool:
        """Whether the two share an area; a shared edge is none."""
        return self.x0_m < other.x1_m and other.x0_m < self.x1_m and self.y0_m < other.y1_m and other.y0_m < self.y1_m

    def inset(self, *, south: float = 0.0, east: float = 0.0, north: float = 0.0, west: float = 0.0) -> "Rectangle":
        """The rectangle that is left when its sides move inwards by so many metres."""
        return Rectangle(self.x0_m + west, self.y0_m + south, self.x1_m - east, self.y1_m - north)


@dataclass(frozen=True)
class Block:
    """Ground between streets, ``area`` up to the kerbs. ``streets`` are its sides that face a street; ``bays`` the
    parking bays cut out of it."""

    area: Rectangle
    streets: frozenset[Side]
    bays: tuple[Rectangle, ...]


@dataclass(frozen=True)
class Building:
    """An upright building. ``height_m`` is measured from the sidewalk to the eaves. ``facade`` names a material,
    ``look`` seeds its details, ``front`` is the side with the door and shops."""

    area: Rectangle
    height_m: float
    storeys: int
    facade: str
    roof: RoofKind
    front: Side
    look: int


@dataclass(frozen=True)
class Tree:
    """A tree or bush at (x, y), ``height_m`` high; ``look`` seeds its shape."""

    x_m: float
    y_m: float
    height_m: float
    look: int
    kind: TreeKind


@dataclass(frozen=True)
class Furniture:
    """A small thing on a sidewalk; ``yaw_rad`` is where its front looks."""

    kind: FurnitureKind
    x_m: float
    y_m: float
    yaw_rad: float


@dataclass(frozen=True)
class BlockPlan:
    """All that stands on one block."""

    block: Block
    buildings: tuple[Building, ...]
    trees: tuple[Tree, ...]
    furniture: tuple[Furniture, ...]


def plan_block(rng: np.random.Generator, block: Block, style: TownStyle) -> BlockPlan:
    """Fills a block by the numbers of a style. The same generator state gives the same plan."""
    walk = sidewalk_of(block, style)
    garden_m = float(rng.uniform(*style.front_garden_m))
    ground = walk.inset(**dict.fromkeys(sorted(block.streets), garden_m))
    depth_m = min(float(rng.uniform(*_DEPTH_M)), min(ground.width_m, ground.depth_m) / 2 - 1.0)
    buildings: list[Building] = []
    for side in ("south", "north", "west", "east"):
        if side in block.streets:
            buildings += _row(rng, ground, side, block.streets, depth_m, style)
    trees = _garden_trees(rng, walk, buildings, style)
    return BlockPlan(block, tuple(buildings), tuple(trees), tuple(_furniture(rng, block, walk)))


def sidewalk_of(block: Block, style: TownStyle) -> Rectangle:
    """What lies behind a block's sidewalks: its area without bays and sidewalks."""
    return block.area.inset(**dict.fromkeys(sorted(block.streets), BAY_DEPTH_M + style.sidewalk_m))


def _row(
    rng: np.random.Generator, ground: Rectangle, side: Side, streets: frozenset[Side], depth_m: float, style: TownStyle
) -> list[Building]:
    """Buildings along one side of the ground, from west to east or from south to north."""
    along_x = side in ("south", "north")
    start_m, end_m = (ground.x0_m, ground.x1_m) if along_x else (ground.y0_m, ground.y1_m)
    if not along_x:
        start_m += depth_m + 3.0 if "south" in streets else 0.0
        end_m -= depth_m + 3.0 if "north" in streets else 0.0
    row: list[Building] = []
    while end_m - start_m >= _LEAST_BUILDING_M:
        width_m = float(rng.uniform(*style.building_width_m))
        if end_m - start_m - width_m < _LEAST_BUILDING_M:
            width_m = end_m - start_m
        width_m = min(width_m, style.building_width_m[1])
        own_depth_m = depth_m * float(rng.uniform(0.8, 1.0))
        row.append(_building(rng, _plot(ground, side, start_m, width_m, own_depth_m), side, style))
        gap_m = float(rng.uniform(*style.gap_m)) if rng.random() < style.gap_share else 0.0
        start_m += width_m + gap_m
    return row


def _plot(ground: Rectangle, side: Side, start_m: float, width_m: float, depth_m: float) -> Rectangle:
    if side == "south":
        return Rectangle(start_m, ground.y0_m, start_m + width_m, ground.y0_m + depth_m)
    if side == "north":
        return Rectangle(start_m, ground.y1_m - depth_m, start_m + width_m, ground.y1_m)
    if side == "west":
        return Rectangle(ground.x0_m, start_m, ground.x0_m + depth_m, start_m + width_m)
    return Rectangle(ground.x1_m - depth_m, start_m, ground.x1_m, start_m + width_m)


def _building(rng: np.random.Generator, area: Rectangle, front: Side, style: TownStyle) -> Building:
    storeys = int(rng.integers(style.storeys[0], style.storeys[1] + 1))
    gable = bool(rng.random() < style.gable_share) and storeys <= 4
    ground_m = GROUND_STOREY_M if storeys > 1 else STOREY_M
    return Building(
        area=area,
        height_m=ground_m + (storeys - 1) * STOREY_M,
        storeys=storeys,
        facade=style.facades[int(rng.integers(len(style.facades)))],
        roof="gable" if gable else "flat",
        front=front,
        look=int(rng.integers(1 << 16)),
    )


def _garden_trees(rng: np.random.Generator, walk: Rectangle, buildings: list[Building], style: TownStyle) -> list[Tree]:
    """Trees and bushes behind the sidewalks, wherever no building stands within two metres."""
    trees: list[Tree] = []
    count = int(walk.width_m * walk.depth_m / 90.0 * style.tree_share)
    for x_share, y_share, height, look, bush in zip(
        rng.random(count), rng.random(count), rng.random(count), rng.integers(1 << 16, size=count),
        rng.random(count) < 0.35, strict=True,
    ):  # fmt: skip
        x_m = walk.x0_m + 1.0 + x_share * (walk.width_m - 2.0)
        y_m = walk.y0_m + 1.0 + y_share * (walk.depth_m - 2.0)
        reach_m = 1.1 if bush else 2.6
        around = Rectangle(x_m - reach_m, y_m - reach_m, x_m + reach_m, y_m + reach_m)
        if any(around.overlaps(building.area) for building in buildings):
            continue
        height_m = 0.9 + 0.9 * height if bush else 5.0 + 5.0 * height
        trees.append(Tree(float(x_m), float(y_m), float(height_m), int(look), "bush" if bush else "garden"))
    return trees


def _furniture(rng: np.random.Generator, block: Block, walk: Rectangle) -> list[Furniture]:
    """Benches, bins, hydrants and cabinets against the inner edge of the sidewalks, never on a bay."""
    kinds: tuple[FurnitureKind, ...] = ("bench", "bin", "hydrant", "cabinet")
    items: list[Furniture] = []
    for side in sorted(block.streets):
        along_x = side in ("south", "north")
        low_m, high_m = (walk.x0_m, walk.x1_m) if along_x else (walk.y0_m, walk.y1_m)
        for along_m in np.arange(low_m + 6.0, high_m - 6.0, 13.0):
            kind = kinds[int(rng.integers(len(kinds)))]
            place_m = float(along_m + rng.uniform(-3.0, 3.0))
            x_m, y_m, yaw_rad = {
                "south": (place_m, walk.y0_m - 0.6, -np.pi / 2),
                "north": (place_m, walk.y1_m + 0.6, np.pi / 2),
                "west": (walk.x0_m - 0.6, place_m, np.pi),
                "east": (walk.x1_m + 0.6, place_m, 0.0),
            }[side]
            items.append(Furniture(kind, x_m, y_m, float(yaw_rad)))
    return items
