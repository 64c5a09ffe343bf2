"""What the tests of meshes measure."""

from collections import Counter

import numpy as np
from numpy.typing import NDArray

from labeler.simulation.meshes import Mesh


def welded(mesh: Mesh) -> NDArray[np.int64]:
    """(F, 3) faces with vertices at one place made one, without those that have no area."""
    _, same = np.unique(np.round(mesh.position_m.astype(np.float64), 4), axis=0, return_inverse=True)
    faces = same.reshape(-1)[mesh.faces]
    return faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 0] != faces[:, 2])]


def open_edges(mesh: Mesh) -> int:
    """Directed edges without a partner that runs back: 0 for a closed surface whose faces all turn the same way."""
    edges: Counter[tuple[int, int]] = Counter()
    for a, b, c in welded(mesh).tolist():
        for edge in ((a, b), (b, c), (c, a)):
            edges[edge] += 1
    return sum(abs(count - edges[b, a]) for (a, b), count in edges.items())


def volume_m3(mesh: Mesh) -> float:
    """The volume that a closed mesh encloses; negative when it is turned inside out."""
    a, b, c = mesh.position_m.astype(np.float64)[mesh.faces].transpose(1, 0, 2)
    return float(np.sum(a * np.cross(b, c)) / 6)
