"""Things that rays can hit: triangles in one frame, searched by Intel Embree (https://www.embree.org) through embreex,
which the extra ``simulation`` brings."""

import importlib
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from labeler.simulation.errors import SimulationError
from labeler.simulation.sumo import INSTALL_COMMAND


@dataclass(frozen=True, eq=False)
class Hits:
    """What R rays met first: ``distance_m`` (R,) float64, inf where nothing; ``triangle`` (R,) int64, -1 where nothing;
    ``cos_incidence`` (R,) float64 between ray and the triangle's normal, 1 at a right angle, 0 where nothing."""

    distance_m: NDArray[np.float64]
    triangle: NDArray[np.int64]
    cos_incidence: NDArray[np.float64]


class Solid:
    """Triangles (T, 3, 3) in metres, each of a ``reflectance`` (T,) for LiDAR between 0 and 1.

    ``radius_m`` is the distance of the farthest corner from the frame's vertical axis. Both sides of a triangle can be
    hit. SimulationError when embreex is not installed."""

    def __init__(self, triangles_m: NDArray[np.floating], reflectance: NDArray[np.floating]) -> None:
        if triangles_m.shape != (len(reflectance), 3, 3):
            raise ValueError(
                f"triangles_m must have shape ({len(reflectance)}, 3, 3) as reflectance, got {triangles_m.shape}"
            )
        self.triangles_m = np.ascontiguousarray(triangles_m, dtype=np.float32)
        self.reflectance = np.asarray(reflectance, dtype=np.float64)
        corners_m = self.triangles_m.reshape(-1, 3)
        self.radius_m = float(np.hypot(corners_m[:, 0], corners_m[:, 1]).max(initial=0.0))
        sides_m = self.triangles_m[:, 1:] - self.triangles_m[:, :1]
        normals = np.cross(sides_m[:, 0], sides_m[:, 1]).astype(np.float64)
        self._normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        scenes, meshes = load_embree()
        self._scene: Any = scenes.EmbreeScene()
        self._mesh: Any = meshes.TriangleMesh(self._scene, self.triangles_m) if len(self.triangles_m) else None

    def cast(self, origins_m: NDArray[np.floating], directions: NDArray[np.floating]) -> Hits:
        """What rays from ``origins_m`` (R, 3) along unit ``directions`` (R, 3) meet first."""
        if self._mesh is None or not len(origins_m):
            return Hits(np.full(len(origins_m), np.inf), np.full(len(origins_m), -1), np.zeros(len(origins_m)))
        met: dict[str, NDArray[Any]] = self._scene.run(
            np.ascontiguousarray(origins_m, dtype=np.float32),
            np.ascontiguousarray(directions, dtype=np.float32),
            output=1,
        )
        triangle = met["primID"].astype(np.int64)
        hit = triangle >= 0
        cos = np.abs(np.einsum("ij,ij->i", directions, self._normals[np.where(hit, triangle, 0)]))
        return Hits(
            distance_m=np.where(hit, met["tfar"].astype(np.float64), np.inf),
            triangle=np.where(hit, triangle, -1),
            cos_incidence=np.where(hit, cos, 0.0),
        )


def load_embree() -> tuple[Any, Any]:
    """embreex's modules of scenes and of meshes. SimulationError when it is not installed."""
    try:
        return importlib.import_module("embreex.rtcore_scene"), importlib.import_module("embreex.mesh_construction")
    except ImportError as error:
        raise SimulationError(
            f"The simulated LiDAR needs embreex, which can't be loaded ({error}). Install it: {INSTALL_COMMAND}"
        ) from error
