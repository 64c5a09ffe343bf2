"""Triangle meshes for the renderer and the LiDAR, and the simple solids that everything is built from.

Coordinates are metres in the mesh's own frame (vehicles: x forward, y left, z up). Faces turn counter-clockwise when
seen from outside, and normals point outwards.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from labeler.simulation.materials import SEMANTIC_OF, Material, Semantic, Shading

VERTEX = np.dtype(
    [
        ("position", "f4", 3),
        ("normal", "f4", 3),
        ("uv", "f4", 2),
        ("layer", "f4"),
        ("color", "f4", 3),
        ("surface", "f4", 4),
        ("shading", "f4"),
        ("semantic", "f4"),
    ]
)
"""One vertex as the graphics card gets it. ``layer`` counts textures (-1: none), ``color`` is linear RGB, ``surface``
the shares of paint, metal, roughness and glass, ``shading`` a ``Shading``, ``semantic`` a ``Semantic``."""


@dataclass(frozen=True)
class Surface:
    """How a part looks and what it is made of. ``color`` is linear RGB from 0 to 1; ``paint`` the share by which the
    instance's paint tints it. ``semantic`` is what its pixels show, where the material does not tell."""

    color: tuple[float, float, float]
    material: Material = Material.PLASTIC
    paint: float = 0.0
    metal: float = 0.0
    rough: float = 0.6
    glass: float = 0.0
    layer: int = -1
    shading: Shading = Shading.PLAIN
    semantic: Semantic | None = None


@dataclass(frozen=True)
class Mesh:
    """(V,) ``vertices`` of dtype ``VERTEX``, (F, 3) int32 ``faces`` and the (F,) uint8 ``material`` of each face."""

    vertices: NDArray[np.void]
    faces: NDArray[np.int32]
    material: NDArray[np.uint8]

    def __post_init__(self) -> None:
        if self.vertices.dtype != VERTEX or self.faces.shape != (len(self.material), 3):
            raise ValueError(
                f"a mesh needs vertices of dtype VERTEX and one material a face, not {self.vertices.dtype}, "
                f"faces {self.faces.shape} and materials {self.material.shape}"
            )
        if len(self.faces) and int(self.faces.max()) >= len(self.vertices):
            raise ValueError(f"a face names vertex {self.faces.max()} of {len(self.vertices)}")

    @property
    def position_m(self) -> NDArray[np.float32]:
        """(V, 3)"""
        return self.vertices["position"]

    @property
    def bounds_m(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Least and greatest x, y, z."""
        position_m = self.position_m.astype(np.float64)
        return position_m.min(axis=0), position_m.max(axis=0)

    def placed(self, offset_m: ArrayLike, *, yaw_rad: float = 0.0, scale: float = 1.0) -> "Mesh":
        """The mesh scaled, turned about z and moved, in this order."""
        cos, sin = np.cos(yaw_rad), np.sin(yaw_rad)
        rotation = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
        vertices = self.vertices.copy()
        vertices["position"] = self.position_m @ rotation.T * scale + np.asarray(offset_m, dtype=np.float64)
        vertices["normal"] = self.vertices["normal"] @ rotation.T
        return Mesh(vertices, self.faces, self.material)


def build_mesh(
    position_m: ArrayLike,
    normal: ArrayLike,
    faces: ArrayLike,
    surface: Surface,
    *,
    uv: ArrayLike | None = None,
) -> Mesh:
    """A mesh of one surface from (V, 3) positions, (V, 3) or (3,) normals, (F, 3) faces and (V, 2) texture places."""
    position = np.asarray(position_m, dtype=np.float64)
    vertices = np.zeros(len(position), dtype=VERTEX)
    vertices["position"] = position
    vertices["normal"] = normal
    vertices["uv"] = 0.0 if uv is None else uv
    vertices["layer"] = surface.layer
    vertices["color"] = surface.color
    vertices["surface"] = (surface.paint, surface.metal, surface.rough, surface.glass)
    vertices["shading"] = surface.shading
    of_material = SEMANTIC_OF.get(surface.material, Semantic.OTHER)
    vertices["semantic"] = of_material if surface.semantic is None else surface.semantic
    triangles = np.asarray(faces, dtype=np.int32).reshape(-1, 3)
    return Mesh(vertices, triangles, np.full(len(triangles), surface.material, dtype=np.uint8))


def join(meshes: Sequence[Mesh]) -> Mesh:
    """One mesh of all. At least one is needed."""
    starts = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.faces + start for mesh, start in zip(meshes, starts[:-1], strict=True)]).astype(np.int32),
        np.concatenate([mesh.material for mesh in meshes]),
    )


def quad(corners_m: ArrayLike, surface: Surface, *, uv: ArrayLike | None = None) -> Mesh:
    """A flat four-sided face from its (4, 3) corners, counter-clockwise as seen from the side it faces."""
    corners = np.asarray(corners_m, dtype=np.float64)
    normal = np.cross(corners[1] - corners[0], corners[3] - corners[0])
    return build_mesh(corners, normal / np.linalg.norm(normal), [[0, 1, 2], [0, 2, 3]], surface, uv=uv)


def box(low_m: ArrayLike, high_m: ArrayLike, surface: Surface) -> Mesh:
    """An axis-aligned box between two corners."""
    low, high = np.asarray(low_m, dtype=np.float64), np.asarray(high_m, dtype=np.float64)
    position: list[NDArray[np.float64]] = []
    normal: list[NDArray[np.float64]] = []
    for axis in range(3):
        a, b = (axis + 1) % 3, (axis + 2) % 3
        for outer in (False, True):
            corners = np.zeros((4, 3))
            corners[:, axis] = high[axis] if outer else low[axis]
            corners[:, a] = [low[a], high[a], high[a], low[a]]
            corners[:, b] = [low[b], low[b], high[b], high[b]]
            position.append(corners if outer else corners[::-1])
            normal.append(np.tile(np.eye(3)[axis] * (1.0 if outer else -1.0), (4, 1)))
    faces = [[4 * k, 4 * k + i, 4 * k + i + 1] for k in range(6) for i in (1, 2)]
    return build_mesh(np.concatenate(position), np.concatenate(normal), faces, surface)


def cylinder(
    start_m: ArrayLike, end_m: ArrayLike, radius_m: float, surface: Surface, *, end_radius_m: float | None = None,
    sides: int = 12,
) -> Mesh:  # fmt: skip
    """A closed cylinder or truncated cone from the middle of one cap to the middle of the other."""
    start, end = np.asarray(start_m, dtype=np.float64), np.asarray(end_m, dtype=np.float64)
    axis = (end - start) / np.linalg.norm(end - start)
    across = np.cross(axis, [0.0, 0.0, 1.0] if abs(axis[2]) < 0.9 else [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    angle = np.arange(sides + 1) / sides * 2 * np.pi
    ring = np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * np.cross(axis, across)
    low = start + ring * radius_m
    high = end + ring * (radius_m if end_radius_m is None else end_radius_m)
    k = np.arange(sides)
    side_faces = np.concatenate(
        [np.stack([k, k + 1, k + sides + 2], axis=1), np.stack([k, k + sides + 2, k + sides + 1], axis=1)]
    )
    fan = np.stack([np.zeros(sides, dtype=int), k + 1, k + 2], axis=1)
    return join(
        [
            build_mesh(np.concatenate([low, high]), np.concatenate([ring, ring]), side_faces, surface),
            build_mesh(np.concatenate([start[None], low]), -axis, fan[:, ::-1], surface),
            build_mesh(np.concatenate([end[None], high]), axis, fan, surface),
        ]
    )


def disc(center_m: ArrayLike, normal: ArrayLike, radius_m: float, surface: Surface, *, sides: int = 16) -> Mesh:
    """A round face whose texture, if any, is centred on it."""
    center, axis = np.asarray(center_m, dtype=np.float64), np.asarray(normal, dtype=np.float64)
    across = np.cross(axis, [0.0, 0.0, 1.0] if abs(axis[2]) < 0.9 else [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    angle = np.arange(sides) / sides * 2 * np.pi
    ring = np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * np.cross(axis, across)
    position = np.concatenate([center[None], center + ring * radius_m])
    uv = np.concatenate([[[0.5, 0.5]], 0.5 + 0.5 * np.stack([np.cos(angle), np.sin(angle)], axis=1)])
    k = np.arange(sides)
    faces = np.stack([np.zeros(sides, dtype=int), k + 1, (k + 1) % sides + 1], axis=1)
    return build_mesh(position, axis, faces, surface, uv=uv)


def smooth_normals(position_m: NDArray[np.float64], faces: NDArray[np.integer]) -> NDArray[np.float64]:
    """(V, 3) unit normals: each the mean of its faces' normals, weighted by area."""
    triangles = position_m[faces]
    face_normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normal = np.zeros_like(position_m)
    for corner in range(3):
        np.add.at(normal, faces[:, corner], face_normal)
    return normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)


def ellipsoid(center_m: ArrayLike, radii_m: ArrayLike, surface: Surface, *, rings: int = 6, sides: int = 10) -> Mesh:
    """A closed ellipsoid along the axes, from circles of latitude; a texture wraps around it once."""
    center, radii = np.asarray(center_m, dtype=np.float64), np.asarray(radii_m, dtype=np.float64)
    polar, angle = np.meshgrid(np.linspace(0, np.pi, rings + 1), np.arange(sides) / sides * 2 * np.pi, indexing="ij")
    unit = np.stack([np.sin(polar) * np.cos(angle), np.sin(polar) * np.sin(angle), np.cos(polar)], axis=-1)
    unit = unit.reshape(-1, 3)
    normal = unit / radii
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    ring, k = np.meshgrid(np.arange(rings), np.arange(sides), indexing="ij")
    upper, upper_next = ring * sides + k, ring * sides + (k + 1) % sides
    towards_top = np.stack([upper_next, upper + sides, upper_next + sides], axis=-1)
    towards_foot = np.stack([upper, upper + sides, upper_next], axis=-1)
    # the topmost ring is one point, and so is the lowest: half of their triangles have no area
    faces = np.concatenate([towards_top[:-1].reshape(-1, 3), towards_foot[1:].reshape(-1, 3)])
    uv = np.stack([angle.ravel() / (2 * np.pi) * 2, polar.ravel() / np.pi], axis=1)
    return build_mesh(center + unit * radii, normal, faces, surface, uv=uv)
