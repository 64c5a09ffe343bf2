import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labeler.carla.coordinates import (
    SENSOR_SE3_CAMERA,
    depth_of,
    parent_SE3_child,
    pixels_of,
    points_of,
    size_of,
    to_carla,
)
from labeler.geometry.se3 import transform_points, yaw_of
from tests.labeler.carla.fake_carla import Image, Location, Rotation, Transform
from tests.labeler.carla.fake_scene import left_handed_matrix

angles = st.floats(-179, 179)
places = st.floats(-500, 500)


def at(x: float = 0, y: float = 0, z: float = 0, *, roll: float = 0, pitch: float = 0, yaw: float = 0) -> Transform:
    return Transform(Location(x, y, z), Rotation(pitch=pitch, yaw=yaw, roll=roll))


def test_a_place_to_the_right_has_a_negative_y() -> None:
    assert parent_SE3_child(at(3, 2, 1))[:3, 3].tolist() == [3.0, -2.0, 1.0]


@pytest.mark.parametrize(
    ("transform", "point", "expected"),
    [
        (at(yaw=90), [1, 0, 0], [0, -1, 0]),  # turned to the right, ahead lies on our negative y
        (at(yaw=90), [0, 1, 0], [1, 0, 0]),  # and what is on its left lies ahead
        (at(pitch=90), [1, 0, 0], [0, 0, 1]),  # nose up: ahead is above
        (at(roll=90), [0, 0, 1], [0, -1, 0]),  # right side down: its top points to the right
        (at(roll=90), [0, 1, 0], [0, 0, 1]),  # and its left side points up
        (at(10, 20, 3, yaw=180), [1, 1, 0], [9, -21, 3]),  # turned round, both axes go the other way
    ],
)
def test_a_point_of_a_child_in_its_parent(transform: Transform, point: list[float], expected: list[float]) -> None:
    moved = transform_points(parent_SE3_child(transform), np.array([point], dtype=float))
    assert moved[0] == pytest.approx(expected, abs=1e-12)


def test_yaw_turns_the_other_way() -> None:
    assert math.degrees(yaw_of(parent_SE3_child(at(yaw=30)))) == pytest.approx(-30)


def test_all_three_angles_as_the_client_of_0_9_16_reckons_them() -> None:
    """The matrix is what get_matrix() of that client says for x 10, y 20, z 3, pitch 10, yaw 30, roll 5."""
    told = np.array([
        [0.852868497, -0.484990567, -0.193389341, 10.0],
        [0.492403865, 0.870297134, -0.011014618, 20.0],
        [0.173648179, -0.0858316422, 0.981060266, 3.0],
        [0.0, 0.0, 0.0, 1.0],
    ])  # fmt: skip
    mirror = np.diag([1.0, -1.0, 1.0, 1.0])
    ours = parent_SE3_child(at(10, 20, 3, roll=5, pitch=10, yaw=30))
    assert ours == pytest.approx(mirror @ told @ mirror, abs=1e-6)
    assert left_handed_matrix(10, 20, 3, 5, 10, 30) == pytest.approx(told, abs=1e-6)  # so the fake may be trusted


@given(places, places, places, angles, st.floats(-89, 89), angles)
def test_there_and_back(x: float, y: float, z: float, roll: float, pitch: float, yaw: float) -> None:
    ours = parent_SE3_child(at(x, y, z, roll=roll, pitch=pitch, yaw=yaw))
    location, rotation = to_carla(ours)
    assert parent_SE3_child(Transform(Location(**location), Rotation(**rotation))) == pytest.approx(ours, abs=1e-9)
    assert np.linalg.det(ours[:3, :3]) == pytest.approx(1.0)  # a rotation, no mirror


def test_a_camera_looks_along_its_sensors_x() -> None:
    """Right, down and ahead of a camera are -y, -z and x of a sensor."""
    ahead_right_down = np.array([[0.0, 0.0, 5.0], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0]])
    expected = [[5.0, 0.0, 0.0], [0.0, -2.0, 0.0], [0.0, 0.0, -3.0]]
    assert transform_points(SENSOR_SE3_CAMERA, ahead_right_down).tolist() == expected


def test_lidar_points_are_mirrored() -> None:
    rows = np.array([[1.0, 2.0, 3.0, 0.25], [-1.0, -2.0, -3.0, 1.0]], dtype=np.float32)
    points_m, intensity = points_of(memoryview(rows.tobytes()))
    assert points_m.tolist() == [[1.0, -2.0, 3.0], [-1.0, 2.0, -3.0]]
    assert intensity.tolist() == [0.25, 1.0]


def test_a_sweep_without_points() -> None:
    points_m, intensity = points_of(memoryview(b""))
    assert (points_m.shape, intensity.shape) == ((0, 3), (0,))


def image(*pixels: tuple[int, int, int]) -> Image:
    """One row of pixels, each blue, green, red."""
    data = bytes(value for pixel in pixels for value in (*pixel, 255))
    return Image(len(pixels), 1, memoryview(data))


def test_pixels_are_blue_green_red() -> None:
    assert pixels_of(image((1, 2, 3), (4, 5, 6))).tolist() == [[[1, 2, 3, 255], [4, 5, 6, 255]]]


def test_depth_is_red_then_green_then_blue() -> None:
    depth_m = depth_of(image((0, 0, 0), (255, 255, 255), (128, 0, 0), (0, 0, 200)))
    assert depth_m[0].tolist() == pytest.approx([0.0, 1000.0, 500.00003, 200 / (256**3 - 1) * 1000])


def test_the_sides_of_a_box_are_twice_its_extent() -> None:
    assert size_of(Location(2.5, 1.0, 0.75)) == (5.0, 2.0, 1.5)
