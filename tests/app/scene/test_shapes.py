"""Drives and boxes as arrays."""

import numpy as np
import pytest

from app.scene.shapes import LINES_PER_BOX, box_corners, box_lines, ground_height_m, point_cloud, unit_cube
from app.scene.types import SceneBox
from labeler.drive.types import Sweep


def sweep_of(xyz_m: list[list[float]], intensity: list[float]) -> Sweep:
    return Sweep(0, np.array(xyz_m, np.float32).reshape(-1, 3), np.array(intensity, np.float32))


def test_thinning_is_even_and_keeps_both_ends() -> None:
    sweep = sweep_of([[i, 0, 0] for i in range(9)], [1] * 9)
    assert point_cloud(sweep, max_points=5).xyz_m[:, 0].tolist() == [0, 2, 4, 6, 8]
    assert len(point_cloud(sweep, max_points=9).xyz_m) == 9


def test_points_that_are_not_numbers_are_left_out() -> None:
    cloud = point_cloud(sweep_of([[1, 2, 3], [float("nan"), 0, 0], [0, float("inf"), 0]], [1, 1, 1]))
    assert cloud.xyz_m.tolist() == [[1, 2, 3]]
    assert cloud.xyz_m.dtype == np.float32


@pytest.mark.parametrize(
    ("intensity", "reflectance"),
    [
        ([0, 128, 255], [0, 128 / 250, 1]),  # bytes; the 98th percentile of three values is 128 + .96 * 127 = 249.92
        ([0.0, 0.5, 1.0], [0, 0.5 / 0.98, 1]),  # fractions
        ([0, 0, 0], [0, 0, 0]),  # a sensor that measures none
        ([float("nan"), 1, 1], [0, 1, 1]),
    ],
)
def test_intensity_becomes_a_share(intensity: list[float], reflectance: list[float]) -> None:
    cloud = point_cloud(sweep_of([[0, 0, 0]] * 3, intensity))
    assert cloud.reflectance.tolist() == pytest.approx(reflectance, abs=1e-3)


def test_no_sweep_is_no_points() -> None:
    assert point_cloud(None).xyz_m.shape == (0, 3)
    assert point_cloud(sweep_of([], [])).reflectance.shape == (0,)


def test_the_ground_is_where_most_near_points_lie() -> None:
    road = [[x, 0.0, -0.33] for x in range(5, 25)]
    wall = [[10.0, 5.0, z / 10] for z in range(10)]
    far_hill = [[60.0, 0.0, 1.5]] * 100
    assert ground_height_m(np.array(road + wall + far_hill, np.float32)) == pytest.approx(-0.35)  # middle of its bin
    assert ground_height_m(np.zeros((0, 3), np.float32)) == 0.0
    assert ground_height_m(np.array(far_hill, np.float32)) == 0.0


def test_lines_of_a_box() -> None:
    box = SceneBox((10.0, 0.0, 1.0), (4.0, 2.0, 1.5), 0.0, 1, "car", None)
    lines = box_lines(box_corners([box]))
    assert lines.shape == (LINES_PER_BOX, 2, 3) == (13, 2, 3)
    lengths = np.linalg.norm(lines[:, 0] - lines[:, 1], axis=1)
    assert sorted(lengths[:12].tolist()) == [1.5] * 4 + [2.0] * 4 + [4.0] * 4
    assert lines[12].tolist() == [[10.0, 0.0, 1.75], [12.0, 0.0, 1.75]]  # roof: from its middle to the front


def test_the_front_turns_with_the_yaw() -> None:
    box = SceneBox((0.0, 0.0, 0.0), (4.0, 2.0, 2.0), np.pi / 2, None, "car", None)
    assert box_lines(box_corners([box]))[12].tolist() == pytest.approx(np.array([[0, 0, 1], [0, 2, 1]]), abs=1e-6)


def test_no_boxes_are_no_lines() -> None:
    assert box_lines(box_corners([])).shape == (0, 2, 3)


def test_cube_faces_look_outward_and_close_the_cube() -> None:
    vertices, faces = unit_cube()
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    normals = np.cross(b - a, c - a)
    assert (np.einsum("ij,ij->i", normals, a + b + c) > 0).all()
    assert np.linalg.norm(normals, axis=1).sum() / 2 == pytest.approx(6.0)  # the surface, in square metres
