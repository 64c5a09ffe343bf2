import numpy as np
import pytest

from labeler.simulation.errors import SimulationError
from labeler.simulation.lidar import LidarConfig, Motion, MovingSolid, Scan, scan
from labeler.simulation.solids import Solid
from tests.labeler.simulation.solid_shapes import box, plane

pytest.importorskip("embreex", reason="needs embreex, of the extra `simulation`")

SENSOR_M = (1.0, 0.0, 2.0)
EXACT = LidarConfig(channels=64, columns=720, noise_m=0.0, dropout=0.0)


def scan_of(
    config: LidarConfig, *vehicles: MovingSolid, ego: Motion | None = None, town: Solid | None = None, seed: int = 0
) -> Scan:
    return scan(
        config,
        ego=ego or Motion(0.0, 0.0, 0.0),
        sensor_m=SENSOR_M,
        town=town or Solid(plane(0.0), np.full(2, 0.9)),
        vehicles=vehicles,
        rng=np.random.default_rng(seed),
    )


def car(motion: Motion, vehicle_id: int = 1) -> MovingSolid:
    return MovingSolid(vehicle_id, Solid(box((-2.0, -1.0, 0.1), (2.0, 1.0, 1.5)), np.full(12, 0.5)), motion)


def test_ground_points_lie_where_each_beam_meets_the_plane() -> None:
    found = scan_of(EXACT)
    elevation_rad = EXACT.elevations_rad()[found.laser_number]
    assert np.abs(found.xyz_m[:, 2]).max() < 1e-4
    from_sensor_m = np.hypot(found.xyz_m[:, 0] - SENSOR_M[0], found.xyz_m[:, 1])
    assert from_sensor_m == pytest.approx(2.0 / np.tan(-elevation_rad), rel=1e-3)
    assert set(found.vehicle_id.tolist()) == {0}


def test_points_on_a_box_lie_on_the_sides_that_face_the_sensor() -> None:
    found = scan_of(EXACT, car(Motion(12.0, 5.0, np.pi / 2)))
    points_m = found.xyz_m[found.vehicle_id == 1]
    assert len(points_m) > 300
    # turned by a quarter, the box spans x 11..13 and y 3..7; the sensor at (1, 0, 2) sees x = 11, y = 3 and the top
    distance_m = np.stack([points_m[:, 0] - 11.0, points_m[:, 1] - 3.0, 1.5 - points_m[:, 2]], axis=1)
    assert distance_m.min() > -1e-3
    assert distance_m.min(axis=1).max() < 1e-3
    assert points_m.max(axis=0) == pytest.approx([13.0, 7.0, 1.5], abs=0.15)


def test_a_standing_world_stays_in_place_while_the_ego_car_drives_and_turns() -> None:
    """A wall ahead at x = 30 stays flat: the ego car's motion is compensated."""
    wall = Solid(box((30.0, -60.0, -5.0), (31.0, 60.0, 20.0)), np.full(12, 0.9))
    found = scan_of(EXACT, town=wall, ego=Motion(0.0, 0.0, 0.0, (15.0, 0.0), 0.5))
    assert len(found.xyz_m) > 3000
    assert found.xyz_m[:, 0] == pytest.approx(np.full(len(found.xyz_m), 30.0), abs=1e-3)


def test_points_are_given_in_the_ego_frame() -> None:
    """Seen from (100, 50) to the north, a wall at y = 70 is 20 m ahead."""
    wall = Solid(box((50.0, 70.0, -5.0), (150.0, 71.0, 20.0)), np.full(12, 0.9))
    found = scan_of(EXACT, town=wall, ego=Motion(100.0, 50.0, np.pi / 2))
    assert found.xyz_m[:, 0] == pytest.approx(np.full(len(found.xyz_m), 20.0), abs=1e-3)


def test_a_moving_vehicle_is_met_where_it_is_at_each_ray_s_time() -> None:
    """A car that comes up from behind is met at the start and at the end of the turn, 20 m/s * 0.1 s apart."""
    found = scan_of(EXACT, car(Motion(-20.0, 0.0, 0.0, (20.0, 0.0))))
    front_m = found.xyz_m[(found.vehicle_id == 1) & (found.xyz_m[:, 2] < 1.4)]
    offset_s = found.offset_ns[(found.vehicle_id == 1) & (found.xyz_m[:, 2] < 1.4)] / 1e9
    assert front_m[:, 0] == pytest.approx(-18.0 + 20.0 * offset_s, abs=2e-3)
    assert front_m[:, 0].max() - front_m[:, 0].min() == pytest.approx(2.0, abs=0.05)


def test_the_sensor_faces_ahead_at_the_sweep_s_time_and_turns_clockwise() -> None:
    found = scan_of(EXACT)
    bearing_rad = np.arctan2(found.xyz_m[:, 1], found.xyz_m[:, 0] - SENSOR_M[0])
    assert found.offset_ns == pytest.approx(-bearing_rad / (2 * np.pi) * 1e8, abs=10)


@pytest.mark.parametrize(
    ("near", "far"),
    [
        # near before far, whichever comes first
        (1, 2),
        (2, 1),
    ],
)
def test_the_nearer_of_two_vehicles_hides_the_other(near: int, far: int) -> None:
    vehicles = sorted(
        [car(Motion(10.0, 0.0, 0.0), near), car(Motion(20.0, 0.0, 0.0), far)], key=lambda one: one.vehicle_id
    )
    found = scan_of(EXACT, *vehicles)
    assert (found.vehicle_id == near).sum() > 500
    # of the far one only the roof can be seen over the near one
    assert found.xyz_m[found.vehicle_id == far, 2].min() > 0.9


def test_noise_stays_within_three_standard_deviations() -> None:
    found = scan_of(LidarConfig(noise_m=0.02), town=Solid(box((20.0, -5.0, -5.0), (21.0, 5.0, 9.0)), np.ones(12)))
    off_m = np.abs(found.xyz_m[:, 0] - 20.0)
    assert 0.005 < off_m.mean() < 0.03
    assert off_m.max() <= 0.06 + 1e-3


@pytest.mark.parametrize(
    ("config", "reflectance", "least", "most"),
    [
        # bright and near: only the constant share is lost
        (LidarConfig(dropout=0.0), 0.9, 0.999, 1.0),
        (LidarConfig(dropout=0.25), 0.9, 0.70, 0.80),
        # too dark to see at 40 m for the most part
        (LidarConfig(dropout=0.0), 0.002, 0.1, 0.45),
        # a black hole
        (LidarConfig(dropout=0.0), 0.0, 0.0, 0.0),
    ],
)
def test_share_of_returns(config: LidarConfig, reflectance: float, least: float, most: float) -> None:
    sides = box((40.0, -2.0, -9.0), (41.0, 2.0, 20.0))
    found = scan_of(config, town=Solid(sides, np.full(12, reflectance)))
    every = scan_of(LidarConfig(dropout=0.0), town=Solid(sides, np.full(12, 1e6)))
    assert least <= len(found.xyz_m) / len(every.xyz_m) <= most


def test_brighter_material_gives_a_higher_intensity() -> None:
    bright = scan_of(EXACT, town=Solid(plane(0.0), np.full(2, 0.8)))
    dark = scan_of(EXACT, town=Solid(plane(0.0), np.full(2, 0.2)))
    assert bright.intensity.mean() > 3 * dark.intensity.mean() > 0


def test_the_seed_decides() -> None:
    first, again, other = (scan_of(LidarConfig(), seed=seed) for seed in (1, 1, 2))
    assert first.xyz_m.tobytes() == again.xyz_m.tobytes()
    assert first.xyz_m.shape != other.xyz_m.shape or first.xyz_m.tobytes() != other.xyz_m.tobytes()


def test_too_few_beams_are_refused() -> None:
    with pytest.raises(SimulationError, match="at least 32 channels"):
        LidarConfig(channels=16)
