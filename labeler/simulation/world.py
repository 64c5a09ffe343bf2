"""A simulated town with everything in it that does not move, and the fleet that may move in it, ready to be drawn.

Static things come in two forms: pieces, which are unique (ground, buildings, signals) and already in the world's frame,
and props, which are copies of a model at a place (trees, lamps, benches).
"""

import math
from collections import defaultdict
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.simulation.blocks import Furniture, Tree
from labeler.simulation.buildings import building_mesh
from labeler.simulation.dimensions import KERB_HEIGHT_M
from labeler.simulation.facades import draw_facades
from labeler.simulation.ground import ground_pieces
from labeler.simulation.layout import TownLayout
from labeler.simulation.meshes import Mesh, join
from labeler.simulation.street_furniture import furniture_mesh, lamp_mesh, signal_mesh
from labeler.simulation.textures import TextureSet
from labeler.simulation.vegetation import TreeModel, tree_models
from labeler.simulation.vehicles import VehicleModel, fleet

_CELL_M = 56.0


@dataclass(frozen=True)
class Piece:
    """Something unique that does not move, in the world's frame. ``is_ground`` tells flat ground from what stands on
    it. ``center_m`` (3,) and ``radius_m`` bound it."""

    mesh: Mesh
    is_ground: bool
    center_m: NDArray[np.float64]
    radius_m: float


@dataclass(frozen=True)
class Prop:
    """A copy of the prop model ``model`` at ``position_m``, turned by ``yaw_rad`` and scaled."""

    model: str
    position_m: tuple[float, float, float]
    yaw_rad: float
    scale: float

    @property
    def matrix(self) -> NDArray[np.float64]:
        """(4, 4) from the model's frame to the world's; its rotation is scaled."""
        cos, sin = math.cos(self.yaw_rad) * self.scale, math.sin(self.yaw_rad) * self.scale
        x_m, y_m, z_m = self.position_m
        return np.array([[cos, -sin, 0, x_m], [sin, cos, 0, y_m], [0, 0, self.scale, z_m], [0, 0, 0, 1]])


@dataclass(frozen=True)
class PropModel:
    """``details`` are what one sees from near to far, ``solid`` is what a LiDAR hits."""

    details: tuple[Mesh, ...]
    solid: Mesh


@dataclass(frozen=True)
class SimulatedWorld:
    """The town and the fleet of one seed. ``models`` are the vehicles by name, ``textures`` all pictures."""

    layout: TownLayout
    textures: TextureSet
    models: dict[str, VehicleModel]
    pieces: tuple[Piece, ...]
    prop_models: dict[str, PropModel]
    props: tuple[Prop, ...]

    @classmethod
    def build(cls, seed: int, *, town: str = "grid", blocks: tuple[int, int] | None = None) -> "SimulatedWorld":
        """The world that follows from ``seed``. Takes about twenty seconds, most of them for drawing pictures.

        SimulationError as from ``TownLayout.generate``."""
        layout = TownLayout.generate(seed, town=town, blocks=blocks)
        textures = TextureSet()
        models = {model.name: model for model in fleet(seed, textures)}
        facades = draw_facades(textures, layout.style.facades, np.random.default_rng([seed, 4]))
        trees = tree_models(textures, np.random.default_rng([seed, 5]))
        standing = [building_mesh(building, facades) for building in layout.buildings]
        standing += [signal_mesh(signal) for signal in layout.signals]
        pieces = [*_grouped(ground_pieces(layout), is_ground=True), *_grouped(standing, is_ground=False)]
        prop_models = {tree.name: PropModel(tree.details, tree.solid) for tree in trees}
        for name, mesh in {"lamp": lamp_mesh(), **_furniture_meshes(layout)}.items():
            prop_models[name] = PropModel((mesh,), mesh)
        return cls(layout, textures, models, tuple(pieces), prop_models, tuple(_props(layout, trees)))

    def static_triangles(self) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.uint8]]:
        """All that does not move: (V, 3) positions in the world's frame, (F, 3) triangles and each one's (F,)
        ``Material``."""
        meshes = [piece.mesh for piece in self.pieces]
        meshes += [
            self.prop_models[prop.model].solid.placed(prop.position_m, yaw_rad=prop.yaw_rad, scale=prop.scale)
            for prop in self.props
        ]
        everything = join(meshes)
        return everything.position_m.astype(np.float64), everything.faces, everything.material


def _grouped(meshes: list[Mesh], *, is_ground: bool) -> list[Piece]:
    """Joins meshes whose middles lie in one cell of a grid: few things to draw, and each still small."""
    cells: dict[tuple[int, int], list[Mesh]] = defaultdict(list)
    for mesh in meshes:
        low, high = mesh.bounds_m
        x_m, y_m = (low + high)[:2] / 2
        cells[int(x_m // _CELL_M), int(y_m // _CELL_M)].append(mesh)
    pieces: list[Piece] = []
    for _, group in sorted(cells.items()):
        mesh = join(group)
        low, high = mesh.bounds_m
        pieces.append(Piece(mesh, is_ground, (low + high) / 2, float(np.linalg.norm(high - low)) / 2))
    return pieces


def _furniture_meshes(layout: TownLayout) -> dict[str, Mesh]:
    return {item.kind: furniture_mesh(item.kind) for item in sorted(layout.furniture, key=lambda item: item.kind)}


def _props(layout: TownLayout, trees: tuple[TreeModel, ...]) -> list[Prop]:
    z_m = KERB_HEIGHT_M
    props = [_tree_prop(tree, trees) for tree in layout.trees]
    props += [Prop("lamp", (lamp.x_m, lamp.y_m, z_m), lamp.yaw_rad, 1.0) for lamp in layout.lamps]
    return props + [_furniture_prop(item) for item in layout.furniture]


def _tree_prop(tree: Tree, models: tuple[TreeModel, ...]) -> Prop:
    kinds = [model for model in models if model.kind == tree.kind]
    model = kinds[tree.look % len(kinds)]
    return Prop(model.name, (tree.x_m, tree.y_m, KERB_HEIGHT_M), tree.look % 628 / 100, tree.height_m)


def _furniture_prop(item: Furniture) -> Prop:
    return Prop(item.kind, (item.x_m, item.y_m, KERB_HEIGHT_M), item.yaw_rad, 1.0)
