"""Trees and bushes: trunks, solid clusters of leaves that a LiDAR hits, and cards of leaves that fray their outline."""

from dataclasses import dataclass

import numpy as np

from labeler.simulation.blocks import TreeKind
from labeler.simulation.materials import Material, Shading
from labeler.simulation.meshes import Mesh, Surface, build_mesh, cylinder, ellipsoid, join, smooth_normals
from labeler.simulation.textures import Ink, Picture, TextureSet

_SPECIES = 3
_WOOD = Surface((0.10, 0.07, 0.05), Material.WOOD, rough=0.95)


@dataclass(frozen=True)
class TreeModel:
    """A tree of height 1 m, to be scaled. ``details`` are what one sees from near and from far, ``solid`` is what a
    LiDAR hits."""

    name: str
    kind: TreeKind
    details: tuple[Mesh, Mesh]
    solid: Mesh


def tree_models(textures: TextureSet, rng: np.random.Generator) -> tuple[TreeModel, ...]:
    """A few trees of each kind."""
    models: list[TreeModel] = []
    kinds: tuple[TreeKind, ...] = ("street", "garden", "bush")
    for kind in kinds:
        for number in range(_SPECIES):
            layer = _draw_leaves(textures, rng)
            look = int(rng.integers(1 << 16))
            near, far = (_parts(np.random.default_rng(look), layer, kind, fine=fine) for fine in (True, False))
            details = (join([*near[0], *near[1]]), join([*far[0], *far[1]]))
            models.append(TreeModel(f"{kind}-{number}", kind, details, join(near[0])))
    return tuple(models)


def _draw_leaves(textures: TextureSet, rng: np.random.Generator) -> int:
    """Leaves on a card; between them the card has holes, but their colour goes on behind them."""
    green = np.array([rng.uniform(52, 88), rng.uniform(84, 116), rng.uniform(28, 48)])
    leaves = Picture((-1.0, 1.0), (-1.0, 1.0), Ink((green[0], green[1], green[2])))
    for _ in range(700):
        out, angle = 0.95 * float(np.sqrt(rng.random())), float(rng.uniform(0, 2 * np.pi))
        center = np.array([out * np.cos(angle), out * np.sin(angle)])
        turn, shade = float(rng.uniform(0, np.pi)), float(rng.uniform(0.5, 1.35))
        along = np.array([np.cos(turn), np.sin(turn)])
        across = np.array([-along[1], along[0]])
        r, g, b = np.clip(green * shade, 0, 255)
        tip = [center + along * 0.09, center + across * 0.035, center - along * 0.09, center - across * 0.035]
        leaves.polygon(tip, Ink((float(r), float(g), float(b)), paint=1.0))
    return textures.add(leaves)


def _parts(rng: np.random.Generator, layer: int, kind: TreeKind, *, fine: bool) -> tuple[list[Mesh], list[Mesh]]:
    """Solid parts and cards of a tree of height 1."""
    return _bush(rng, layer, fine=fine) if kind == "bush" else _tree(rng, layer, kind, fine=fine)


def _tree(rng: np.random.Generator, layer: int, kind: TreeKind, *, fine: bool) -> tuple[list[Mesh], list[Mesh]]:
    trunk, crown = (0.42, 0.30) if kind == "street" else (0.30, 0.33)
    slim = float(rng.uniform(0.75, 1.0))
    lean = rng.normal(0, 0.01, size=2)
    solid = [
        cylinder((0, 0, 0), (lean[0], lean[1], trunk + 0.25), 0.024, _WOOD, end_radius_m=0.012, sides=7 if fine else 4)
    ]
    middle = np.array([lean[0], lean[1], 1.0 - crown * 0.92])
    for k in range(5 if fine else 3):
        out = _direction(rng) * (0.0 if k == 0 else 0.48 * crown) * (slim, slim, 0.8)
        size = crown * (0.72 if k == 0 else float(rng.uniform(0.42, 0.56)))
        solid.append(_cluster(rng, middle + out, np.array([size * slim, size * slim, size * 0.92]), layer, fine=fine))
    reach = crown * np.array([slim, slim, 1.0])
    cards = [_card(rng, middle, reach, 0.42 * crown, layer) for _ in range(26 if fine else 7)]
    return solid, cards


def _bush(rng: np.random.Generator, layer: int, *, fine: bool) -> tuple[list[Mesh], list[Mesh]]:
    middle = np.array([0.0, 0.0, 0.45])
    solid = [
        _cluster(
            rng, middle + rng.uniform(-0.25, 0.25, size=3) * (1, 1, 0.3), np.array([0.42, 0.42, 0.46]), layer, fine=fine
        )
        for _ in range(3 if fine else 1)
    ]
    cards = [_card(rng, middle, np.array([0.55, 0.55, 0.42]), 0.25, layer) for _ in range(12 if fine else 3)]
    return solid, cards


def _cluster(
    rng: np.random.Generator, center: np.ndarray[tuple[int], np.dtype[np.float64]],
    radii: np.ndarray[tuple[int], np.dtype[np.float64]], layer: int, *, fine: bool,
) -> Mesh:  # fmt: skip
    """A bumpy ball of leaves."""
    surface = Surface((0.62, 0.62, 0.62), Material.FOLIAGE, rough=0.95, layer=layer)
    ball = ellipsoid((0, 0, 0), (1, 1, 1), surface, rings=6 if fine else 4, sides=9 if fine else 6)
    unit = ball.position_m.astype(np.float64)
    waves = np.sin(unit @ rng.normal(0, 3.5, size=(3, 2)) + rng.uniform(0, 6, size=2))
    bump = 1 + 0.16 * waves[:, 0] * waves[:, 1]
    position = center + unit * bump[:, None] * radii
    normal = smooth_normals(unit * bump[:, None] * radii, ball.faces)
    flat = np.linalg.norm(normal, axis=1) < 0.5
    normal[flat] = unit[flat]
    return build_mesh(position, normal, ball.faces, surface, uv=ball.vertices["uv"])


def _card(
    rng: np.random.Generator, middle: np.ndarray[tuple[int], np.dtype[np.float64]],
    crown: np.ndarray[tuple[int], np.dtype[np.float64]], size: float, layer: int,
) -> Mesh:  # fmt: skip
    """A square of leaves that stands out of the crown's surface, lit as the crown is."""
    out = _direction(rng)
    center = middle + out * crown * float(rng.uniform(0.50, 0.80))
    across = np.cross(out, _direction(rng))
    across /= np.linalg.norm(across)
    up = out + np.cross(out, across) * float(rng.uniform(-0.8, 0.8))
    up /= np.linalg.norm(up)
    corners = np.array([center + size * (a * across + b * up) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    normal = (corners - middle) / np.linalg.norm(corners - middle, axis=1, keepdims=True)
    surface = Surface((1.0, 1.0, 1.0), Material.FOLIAGE, rough=0.95, layer=layer, shading=Shading.CUTOUT)
    return build_mesh(corners, normal, [[0, 1, 2], [0, 2, 3]], surface, uv=[[0, 0], [1, 0], [1, 1], [0, 1]])


def _direction(rng: np.random.Generator) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    direction = rng.normal(size=3)
    return direction / np.linalg.norm(direction)
