"""The cloud of a direction: where a camera looks becomes x, whatever the rig; ground and paint as they are."""

import numpy as np
import pytest

from labeler.drive.types import Calibration, Camera, Sweep
from labeler.geometry.se3 import se3
from labeler.lidar import LidarConfig, Scene, View, prepare_scene
from labeler.lidar.pillars.direction import PAINTED_CLASSES, Direction, direction_cloud
from labeler.lidar.pillars.grouping import Grid
from labeler.segmentation import SegmentationScores

CONFIG = LidarConfig()
AHEAD = np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])
LEFT = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]) @ AHEAD
DOWN = np.array([[0.0, -1, 0], [-1, 0, 0], [0, 0, -1]])
INTRINSICS = np.array([[100.0, 0, 200], [0, 100, 100], [0, 0, 1]])


def view(rotation: np.ndarray = AHEAD, place_m: tuple[float, float, float] = (0, 0, 0)) -> View:
    return View.of(Camera("camera", 400, 200, Calibration(INTRINSICS, se3(rotation, place_m))))


def scene(*points: tuple[float, float, float], road_z_m: float = -1.5) -> Scene:
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(-30, 30, 1.0), np.arange(-30, 30, 1.0)))
    road = np.stack([x, y, np.full(len(x), road_z_m)], axis=1)
    xyz_m = np.concatenate([road, np.array(points).reshape(-1, 3)]).astype(np.float32)
    return prepare_scene(Sweep(0, xyz_m, np.linspace(0, 50, len(xyz_m)).astype(np.float32)), CONFIG)


def scores(vehicle: int) -> SegmentationScores:
    planes = np.zeros((2, 50, 100), np.uint8)
    planes[0], planes[1] = vehicle, 255 - vehicle
    return SegmentationScores(("vehicle", "building"), planes, stride_px=4, size_px=(400, 200))


@pytest.mark.parametrize(
    ("rotation", "yaw_deg"),
    [
        (AHEAD, 0),
        (LEFT, 90),
        (DOWN, 0),  # straight down: the upper edge of its image is ahead
    ],
)
def test_a_direction_is_where_the_camera_looks(rotation: np.ndarray, yaw_deg: float) -> None:
    direction = Direction.of(view(rotation, (1, 2, 3)))
    assert np.degrees(direction.yaw_rad) == pytest.approx(yaw_deg)
    np.testing.assert_allclose(direction.origin_m, [1, 2])


def test_places_go_into_a_direction_and_back() -> None:
    direction = Direction.of(view(LEFT, (1, 2, 3)))
    inside = direction.from_ego(np.array([[1.0, 12.0], [0.0, 2.0]]))
    np.testing.assert_allclose(inside, [[10, 0], [0, 1]], atol=1e-9)  # ahead of the camera; to its left
    np.testing.assert_allclose(direction.to_ego(inside), [[1, 12], [0, 2]], atol=1e-9)


@pytest.mark.parametrize("road_z_m", [-1.5, 0.0, 0.7])
def test_heights_are_above_the_ground_and_the_ground_itself_is_left_out(road_z_m: float) -> None:
    made = scene((10, 0, road_z_m + 1.0), road_z_m=road_z_m)
    cloud, rows = direction_cloud(made, view(place_m=(0, 0, road_z_m + 1.5)), scores(255), CONFIG)
    np.testing.assert_allclose(cloud[:, :3], [[10, 0, 1.0]], atol=0.05)
    np.testing.assert_array_equal(made.xyz_m[rows], [[10, 0, np.float32(road_z_m + 1.0)]])


def test_points_carry_the_scores_of_their_pixel_and_unseen_ones_none() -> None:
    assert PAINTED_CLASSES == ("vehicle", "building", "vegetation")
    cloud, _ = direction_cloud(scene((10, 0, 0), (-10, 0, 0)), view(), scores(204), CONFIG)
    np.testing.assert_allclose(cloud[0, 4:], [1, 0.8, 0.2, 0], atol=0.01)  # the network does not know vegetation
    np.testing.assert_array_equal(cloud[1, 4:], [0, 0, 0, 0])  # behind the camera


def test_without_a_segmentation_points_are_seen_but_not_painted() -> None:
    cloud, _ = direction_cloud(scene((10, 0, 0)), view(), None, CONFIG)
    np.testing.assert_array_equal(cloud[0, 4:], [1, 0, 0, 0])


def test_within_a_grid_points_are_as_without_it() -> None:
    grid = Grid(x_min_m=0, y_min_m=-4, cell_m=1, rows=20, columns=8)
    made = scene((10, 0, 0), (12, 0, 0), (10, 5, 0), (25, 1, 0), (19.5, -3.5, 0))  # two of them outside
    whole, rows = direction_cloud(made, view(), scores(204), CONFIG)
    inside, inside_rows = direction_cloud(made, view(), scores(204), CONFIG, within=grid)
    np.testing.assert_array_equal(inside[:, 0], np.array([10, 12, 19.5], np.float32))
    np.testing.assert_array_equal(inside, whole[np.isin(rows, inside_rows)])


def test_an_empty_sweep_gives_an_empty_cloud() -> None:
    empty = prepare_scene(Sweep(0, np.zeros((0, 3), np.float32), np.zeros(0, np.float32)), CONFIG)
    cloud, rows = direction_cloud(empty, view(), scores(255), CONFIG)
    assert cloud.shape == (0, 8)
    assert len(rows) == 0


@pytest.mark.parametrize(
    ("intensity", "expected"),
    [
        ([0.0, 50.0, 100.0], [0, 0.5, 1]),  # a sensor that counts to 100
        ([0.0, 0.5, 1.0], [0, 0.5, 1]),  # one that counts to 1
        ([np.nan, -np.inf, 8.0], [0, 0, 1]),
        ([0.0, 0.0], [0, 0]),  # not recorded
        ([], []),
    ],
)
def test_intensity_is_a_share_of_the_strongest(intensity: list[float], expected: list[float]) -> None:
    points = np.zeros((len(intensity), 3), np.float32)
    made = prepare_scene(Sweep(0, points, np.array(intensity, np.float32)), CONFIG)
    np.testing.assert_allclose(made.relative_intensity, expected, atol=0.02)
