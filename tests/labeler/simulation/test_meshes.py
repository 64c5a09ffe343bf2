"""Solids are closed, turn outwards and have the volume they should."""

import numpy as np
import pytest

from labeler.simulation.materials import Material, Semantic
from labeler.simulation.meshes import (
    VERTEX,
    Mesh,
    Surface,
    box,
    build_mesh,
    cylinder,
    disc,
    ellipsoid,
    join,
    quad,
    smooth_normals,
)
from tests.labeler.simulation.mesh_checks import open_edges, volume_m3

GREY = Surface((0.5, 0.5, 0.5))


@pytest.mark.parametrize(
    ("mesh", "expected_m3", "tolerance"),
    [
        (box((-1, -2, 0), (1, 2, 3), GREY), 24.0, 1e-5),
        (cylinder((0, 0, 0), (0, 0, 2), 0.5, GREY, sides=64), np.pi * 0.5, 0.01),  # a polygon is a little smaller
        (cylinder((1, 0, 0), (1, 4, 0), 1.0, GREY, end_radius_m=0.0, sides=64), np.pi * 4 / 3, 0.02),  # a cone
        (ellipsoid((3, 2, 1), (1, 2, 3), GREY, rings=48, sides=48), 4 / 3 * np.pi * 6, 0.15),
    ],
)
def test_solids_are_closed_and_turned_outwards(mesh: Mesh, expected_m3: float, tolerance: float) -> None:
    assert open_edges(mesh) == 0
    assert volume_m3(mesh) == pytest.approx(expected_m3, abs=tolerance)


def test_normals_of_a_box_point_outwards() -> None:
    mesh = box((-1, -1, -1), (1, 1, 1), GREY)

    outwards = np.sum(mesh.vertices["normal"] * mesh.position_m, axis=1)
    np.testing.assert_allclose(outwards, 1.0)


def test_a_quad_faces_the_side_from_which_it_turns_counter_clockwise() -> None:
    mesh = quad([(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0)], GREY)

    np.testing.assert_allclose(mesh.vertices["normal"], [[0, 0, 1]] * 4)


def test_a_disc_is_round_and_faces_its_normal() -> None:
    mesh = disc((1, 2, 3), (0, -1, 0), 0.5, GREY, sides=12)

    rim = mesh.position_m[1:] - (1, 2, 3)
    np.testing.assert_allclose(np.linalg.norm(rim, axis=1), 0.5, rtol=1e-6)
    a, b, c = mesh.position_m[mesh.faces].transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    assert (normal[:, 1] < 0).all()


def test_placing_scales_then_turns_then_moves() -> None:
    mesh = box((0, 0, 0), (1, 2, 3), GREY).placed((10, 20, 30), yaw_rad=np.pi / 2, scale=2.0)

    low, high = mesh.bounds_m
    np.testing.assert_allclose(low, [10 - 4, 20, 30], atol=1e-5)
    np.testing.assert_allclose(high, [10, 20 + 2, 30 + 6], atol=1e-5)


def test_joining_keeps_faces_and_materials() -> None:
    mesh = join([box((0, 0, 0), (1, 1, 1), GREY), box((2, 0, 0), (3, 1, 1), GREY)])

    assert mesh.faces.shape == (24, 3)
    assert mesh.faces.max() == 47
    assert volume_m3(mesh) == pytest.approx(2.0)


def test_smooth_normals_of_a_flat_sheet() -> None:
    position = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=np.float64)

    np.testing.assert_allclose(smooth_normals(position, np.array([[0, 1, 2], [0, 2, 3]])), [[0, 0, 1]] * 4)


@pytest.mark.parametrize(
    ("surface", "expected"),
    [
        (Surface((1, 1, 1), Material.MARKING), Semantic.ROAD),
        (Surface((1, 1, 1), Material.WALL), Semantic.BUILDING),
        (Surface((1, 1, 1), Material.WOOD), Semantic.VEGETATION),  # a trunk
        (Surface((1, 1, 1), Material.WOOD, semantic=Semantic.OTHER), Semantic.OTHER),  # a bench says so itself
        (Surface((1, 1, 1), Material.METAL), Semantic.OTHER),  # a material that no class is named for
    ],
)
def test_a_surface_shows_the_class_of_its_material_unless_it_says_otherwise(
    surface: Surface, expected: Semantic
) -> None:
    assert set(box((0, 0, 0), (1, 1, 1), surface).vertices["semantic"].tolist()) == {expected}


def test_a_mesh_checks_its_parts() -> None:
    with pytest.raises(ValueError, match="names vertex 7 of 3"):
        build_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [0, 0, 1], [[0, 1, 7]], GREY)
    with pytest.raises(ValueError, match="one material a face"):
        Mesh(np.zeros(3, dtype=VERTEX), np.zeros((1, 3), dtype=np.int32), np.zeros(2, dtype=np.uint8))
