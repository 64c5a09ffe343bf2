"""A closed box with rounded edges whose five visible sides carry pictures: the body of buses and trucks."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from labeler.simulation.materials import Material, Shading
from labeler.simulation.meshes import Mesh, Surface, build_mesh, join, smooth_normals


@dataclass(frozen=True)
class BoxLayers:
    """Texture layers of a box's sides. Each picture covers the whole side, as one sees it from outside; the top's runs
    along x to the right and along y upwards."""

    left: int
    right: int
    front: int
    rear: int
    top: int


def rounded_box(low_m: ArrayLike, high_m: ArrayLike, edge_m: float, layers: BoxLayers, *, steps: int = 3) -> Mesh:
    """A box between two corners, its edges rounded by ``edge_m`` in ``steps`` steps. x is forward, y to the left."""
    low, high = np.asarray(low_m, dtype=np.float64), np.asarray(high_m, dtype=np.float64)
    turn = np.linspace(0, np.pi / 2, steps + 1)
    x_m = np.concatenate([high[0] - edge_m * (1 - np.cos(turn)), low[0] + edge_m * (1 - np.cos(turn))[::-1]])
    inset = np.concatenate([edge_m * (1 - np.sin(turn)), edge_m * (1 - np.sin(turn))[::-1]])
    rings = [_ring(low[1:] + by, high[1:] - by, max(edge_m - by, 0.2 * edge_m), turn) for by in inset]
    size = len(rings[0])
    middle = (low[1:] + high[1:]) / 2
    position = np.concatenate(
        [np.column_stack([np.full(size, x), ring]) for x, ring in zip(x_m, rings, strict=True)]
        + [[[high[0], *middle]], [[low[0], *middle]]]
    )
    k, j = np.meshgrid(np.arange(len(rings) - 1), np.arange(size), indexing="ij")
    a, b = (k * size + j).ravel(), (k * size + (j + 1) % size).ravel()
    j = np.arange(size)
    nose, tail, last = len(rings) * size, len(rings) * size + 1, (len(rings) - 1) * size
    faces = np.concatenate([
        np.stack([a, a + size, b], axis=1), np.stack([b, a + size, b + size], axis=1),
        np.stack([np.full(size, nose), j, (j + 1) % size], axis=1),
        np.stack([np.full(size, tail), last + (j + 1) % size, last + j], axis=1),
    ])  # fmt: skip
    return _textured(position, faces, low, high, layers)


def _ring(
    low: NDArray[np.float64], high: NDArray[np.float64], edge_m: float, turn: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(R, 2) y and z around a rounded rectangle, counter-clockwise as seen from the front (y right, z up)."""
    cos, sin = np.cos(turn), np.sin(turn)
    corners = [
        (high[0] - edge_m, high[1] - edge_m, cos, sin),
        (low[0] + edge_m, high[1] - edge_m, -sin, cos),
        (low[0] + edge_m, low[1] + edge_m, -cos, -sin),
        (high[0] - edge_m, low[1] + edge_m, sin, -cos),
    ]
    return np.concatenate([np.column_stack([y + edge_m * c, z + edge_m * s]) for y, z, c, s in corners])


def _textured(
    position: NDArray[np.float64], faces: NDArray[np.int64], low: NDArray[np.float64], high: NDArray[np.float64],
    layers: BoxLayers,
) -> Mesh:  # fmt: skip
    """Splits the surface by the side that each face looks to, and projects that side's picture on it."""
    a, b, c = position[faces].transpose(1, 0, 2)
    face_normal = np.cross(b - a, c - a)
    normal = smooth_normals(position, faces)
    weight = face_normal * (1.0, 1.0, 0.8)
    axis = np.abs(weight).argmax(axis=1)
    side = 2 * axis + (np.take_along_axis(face_normal, axis[:, None], axis=1)[:, 0] > 0)
    share = (position - low) / (high - low)
    x, y, z = share.T
    places = {
        0: (1 - y, 1 - z), 1: (y, 1 - z),
        2: (x, 1 - z), 3: (1 - x, 1 - z),
        4: (x, y), 5: (x, 1 - y),
    }  # fmt: skip
    numbers = {0: layers.rear, 1: layers.front, 2: layers.right, 3: layers.left, 5: layers.top}
    parts: list[Mesh] = []
    for looks in range(6):
        chosen = faces[side == looks]
        used, corner = np.unique(chosen, return_inverse=True)
        surface = Surface((0.02, 0.02, 0.02), rough=0.9)
        if looks in numbers:
            surface = Surface(
                (1.0, 1.0, 1.0), Material.PAINT, paint=1.0, rough=0.3, layer=numbers[looks], shading=Shading.BODY
            )
        uv = np.column_stack(places[looks])[used]
        parts.append(build_mesh(position[used], normal[used], corner.reshape(-1, 3), surface, uv=uv))
    return join(parts)
