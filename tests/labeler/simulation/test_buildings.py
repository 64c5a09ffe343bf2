"""Buildings stand on their plots, face outwards and are as high as planned."""

import numpy as np
import pytest

from labeler.simulation.blocks import GROUND_STOREY_M, STOREY_M, Building, Rectangle, RoofKind, Side
from labeler.simulation.buildings import building_mesh
from labeler.simulation.dimensions import KERB_HEIGHT_M
from labeler.simulation.facades import Facade
from labeler.simulation.materials import Shading
from labeler.simulation.meshes import Mesh

FACADES = {"brick": [Facade(0, 1, 2)], "plaster": [Facade(3, 4, 5)]}
PLOT = Rectangle(10.0, 20.0, 26.0, 32.0)


def building(
    roof: RoofKind, *, storeys: int = 3, facade: str = "brick", front: Side = "south", look: int = 5
) -> Building:
    return Building(PLOT, GROUND_STOREY_M + 2 * STOREY_M, 3, facade, roof, front, 5)


def walls(mesh: Mesh) -> tuple[np.ndarray[tuple[int, ...], np.dtype[np.float64]], ...]:
    """(T, 3, 3) triangles with a facade and their (T, 3) normals by the turn of their corners."""
    is_wall = (mesh.vertices["shading"] == Shading.FACADE)[mesh.faces].all(axis=1)
    triangles = mesh.position_m[mesh.faces[is_wall]].astype(np.float64)
    return triangles, np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])


@pytest.mark.parametrize("roof", ["flat", "gable"])
def test_walls_stand_on_the_plot_face_outwards_and_have_the_planned_height(roof: RoofKind) -> None:
    triangles, normals = walls(building_mesh(building(roof), FACADES))

    corners = triangles.reshape(-1, 3)
    np.testing.assert_allclose(corners.min(axis=0), [10, 20, KERB_HEIGHT_M], atol=1e-5)
    np.testing.assert_allclose(corners.max(axis=0), [26, 32, KERB_HEIGHT_M + 4.2 + 2 * 3.2], atol=1e-5)
    outwards = np.sum(normals * (triangles.mean(axis=1) - [18, 26, 5]), axis=1)
    assert (outwards > 0).all()
    area = np.linalg.norm(normals, axis=1).sum() / 2
    assert area == pytest.approx(2 * (16 + 12) * 10.6, rel=1e-5)


def test_a_gable_rises_over_the_shorter_side() -> None:
    flat, gable = (building_mesh(building(roof), FACADES).bounds_m[1][2] for roof in ("flat", "gable"))

    eaves_m = KERB_HEIGHT_M + 10.6
    assert eaves_m < flat < eaves_m + 3.5
    assert gable == pytest.approx(eaves_m + 0.42 * 12 + 0.7, abs=1e-4)  # the chimney tops the ridge by 0.7 m


@pytest.mark.parametrize(
    ("front", "axis", "sign"), [("south", 1, -1), ("north", 1, 1), ("west", 0, -1), ("east", 0, 1)]
)
def test_balconies_hang_on_the_front_alone(front: Side, axis: int, sign: int) -> None:
    mesh = building_mesh(building("gable", facade="plaster", front=front), FACADES)
    low, high = (np.array(side) for side in ((10.0, 20.0), (26.0, 32.0)))
    below_roof = mesh.position_m[mesh.position_m[:, 2] < 8.0]

    reach = np.array([low - below_roof[:, :2].min(axis=0), below_roof[:, :2].max(axis=0) - high])
    expected = np.zeros((2, 2))
    expected[int(sign > 0), axis] = 1.0
    np.testing.assert_allclose(reach, expected, atol=1e-5)
