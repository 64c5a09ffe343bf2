import numpy as np
import pytest

from labeler.lidar import LidarConfig, above_ground, estimate_ground

CONFIG = LidarConfig()


def plane(height_m: float, slope: float, *, reach_m: float = 40.0, step_m: float = 0.5) -> np.ndarray:
    """Points of a road that rises along x."""
    side = np.arange(-reach_m, reach_m, step_m) + step_m / 2
    x, y = (axis.ravel() for axis in np.meshgrid(side, side, indexing="ij"))
    return np.stack([x, y, height_m + slope * x], axis=1).astype(np.float32)


@pytest.mark.parametrize(
    ("height_m", "slope"),
    [
        (0.0, 0.0),  # the ego frame lies on the road
        (-1.73, 0.0),  # the ego frame is that of a LiDAR on a roof, as in KITTI
        (-1.73, 0.05),  # a ramp
        (0.3, 0.15),  # a steep street
    ],
)
def test_ground_follows_a_plane_of_any_height_and_slope(height_m: float, slope: float):
    ground = estimate_ground(plane(height_m, slope), CONFIG)
    places = np.array([[0.0, 0.0], [20.0, -10.0], [-20.0, 5.0]])
    np.testing.assert_allclose(ground.at(places), height_m + slope * places[:, 0], atol=0.15)


def test_ground_points_on_a_slope_are_removed_and_an_object_on_it_stays():
    road = plane(-1.7, 0.15)
    post = np.array([[10.2, 3.1, -1.7 + 1.53 + z] for z in np.arange(0.4, 1.7, 0.1)], np.float32)
    points = np.concatenate([road, post])
    clear = above_ground(points, estimate_ground(points, CONFIG), CONFIG)
    near = np.abs(points[:, :2]).max(axis=1) < 30
    assert clear[: len(road)][near[: len(road)]].mean() < 0.01
    assert clear[len(road) :].all()


def test_ground_is_carried_on_under_a_vehicle_that_hides_it():
    road = plane(0.0, 0.0)
    under = (np.abs(road[:, 0] - 15) < 4) & (np.abs(road[:, 1]) < 1.5)
    body = plane(0.6, 0.0)[under]  # what is seen of it hangs 0.6 m above the road
    points = np.concatenate([road[~under], body])
    assert above_ground(body, estimate_ground(points, CONFIG), CONFIG).all()


def test_mirror_images_below_the_ground_do_not_pull_it_down():
    mirror = np.array([[8.0 + x, 2.0 + y, -4.0] for x in range(3) for y in range(3)], np.float32)
    points = np.concatenate([plane(0.0, 0.0), mirror])
    assert estimate_ground(points, CONFIG).at(np.array([[9.0, 3.0]]))[0] == pytest.approx(0.0, abs=0.1)


@pytest.mark.parametrize(
    "points",
    [
        np.zeros((0, 3), np.float32),  # an empty sweep
        np.full((5, 3), np.nan, np.float32),  # nothing usable in it
        np.full((5, 3), 1e6, np.float32),  # everything beyond the grid
    ],
)
def test_points_of_unknown_ground_are_kept(points: np.ndarray):
    ground = estimate_ground(points, CONFIG)
    assert np.isnan(ground.at(np.array([[0.0, 0.0]]))).all()
    assert above_ground(np.array([[1.0, 2.0, 3.0]]), ground, CONFIG).all()


def test_points_that_are_not_finite_change_nothing():
    road = plane(-1.0, 0.0)
    broken = np.concatenate([road, np.array([[np.nan, 0, 0], [0, np.inf, 0], [0, 0, np.nan]], np.float32)])
    places = np.array([[0.0, 0.0], [10.0, 10.0]])
    np.testing.assert_allclose(
        estimate_ground(broken, CONFIG).at(places), estimate_ground(road, CONFIG).at(places), atol=0.01
    )
