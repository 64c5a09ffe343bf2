"""Real SUMO on the smallest town, with the real fleet."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from labeler.simulation.errors import SimulationError
from labeler.simulation.layout import TownLayout
from labeler.simulation.sumo import run_sumo
from labeler.simulation.traffic import Traffic, TrafficConfig, TrafficFrame, simulate_traffic
from labeler.simulation.vehicles import VehicleModel, fleet

pytest.importorskip("sumo", reason="needs eclipse-sumo, of the extra `simulation`")

LAYOUT = TownLayout.generate(3, town="grid-small")
CONFIG = TrafficConfig(seed=3, frames=120, vehicles=20)


@pytest.fixture(scope="module")
def models() -> tuple[VehicleModel, ...]:
    return fleet(3)


@pytest.fixture(scope="module")
def traffic(models: tuple[VehicleModel, ...], tmp_path_factory: pytest.TempPathFactory) -> Traffic:
    return simulate_traffic(LAYOUT, models, CONFIG, tmp_path_factory.mktemp("traffic"))


@pytest.fixture(scope="module")
def frames(traffic: Traffic) -> list[TrafficFrame]:
    return list(traffic.frames())


def as_array(frames: list[TrafficFrame]) -> np.ndarray:
    """(frames, vehicles, 4) x, y, yaw and speed."""
    placed = [frame.driving for frame in frames]
    return np.array([np.stack([one.x_m, one.y_m, one.yaw_rad, one.speed_mps], axis=1) for one in placed])


def test_every_frame_holds_the_exact_number_of_vehicles(frames: list[TrafficFrame]) -> None:
    assert [frame.index for frame in frames] == list(range(120))
    assert all(frame.driving.vehicle_id.tolist() == list(range(1, 21)) for frame in frames)


def test_vehicles_stay_on_the_streets_and_drive(frames: list[TrafficFrame]) -> None:
    found = as_array(frames)
    assert LAYOUT.on_carriageway(found[..., :2].reshape(-1, 2)).all()
    poles_m = np.array([(signal.x_m, signal.y_m) for signal in LAYOUT.signals])
    assert np.linalg.norm(found[:, :, None, :2] - poles_m, axis=3).min() > 1.2
    assert 2.0 < found[..., 3].mean() < 15.0


def test_steps_are_as_long_as_the_speed_says(frames: list[TrafficFrame]) -> None:
    found = as_array(frames)
    step_m = np.linalg.norm(np.diff(found[..., :2], axis=0), axis=2)
    # 0.1 s at the mean of both speeds; a body's middle cuts a bend short by a little
    expected_m = (found[1:, :, 3] + found[:-1, :, 3]) / 2 * 0.1
    assert np.abs(step_m - expected_m).max() < 0.35
    velocity_mps = np.array([frame.driving.velocity_mps for frame in frames])
    assert np.abs(np.linalg.norm(velocity_mps, axis=2) - found[..., 3]).max() < 4.0


def test_bodies_point_where_they_go(
    traffic: Traffic, models: tuple[VehicleModel, ...], frames: list[TrafficFrame]
) -> None:
    """The rear axle never slides sideways."""
    by_name = {model.name: model for model in models}
    rear_m = np.array([by_name[traffic.models[k]].rear_axle_m for k in range(1, 21)])
    found = as_array(frames)
    heading = np.stack([np.cos(found[..., 2]), np.sin(found[..., 2])], axis=2)
    axle_m = found[..., :2] + heading * rear_m[None, :, None]
    moved_m = np.diff(axle_m, axis=0)
    aside_m = moved_m[..., 0] * -heading[:-1, :, 1] + moved_m[..., 1] * heading[:-1, :, 0]
    assert np.abs(aside_m).max() < 0.06


def test_vehicles_keep_apart(traffic: Traffic, frames: list[TrafficFrame]) -> None:
    found = as_array(frames)[::10, :, :2]
    apart_m = np.linalg.norm(found[:, :, None] - found[:, None], axis=3) + 100 * np.eye(20)
    assert apart_m.min() > 2.0


def test_the_ego_car_is_a_car_that_turns(
    traffic: Traffic, models: tuple[VehicleModel, ...], frames: list[TrafficFrame]
) -> None:
    by_name = {model.name: model for model in models}
    assert by_name[traffic.models[traffic.ego_id]].category == "car"
    yaw_rad = np.unwrap(as_array(frames)[:, traffic.ego_id - 1, 2])
    assert np.ptp(yaw_rad) > np.radians(70)


def test_parked_vehicles_stand_in_their_slots(traffic: Traffic, models: tuple[VehicleModel, ...]) -> None:
    by_name = {model.name: model for model in models}
    parked = traffic.parked
    slots = np.array([(slot.x_m, slot.y_m, slot.yaw_rad) for slot in LAYOUT.slots])
    assert 0.4 * len(slots) < len(parked.vehicle_id) < 0.8 * len(slots)
    assert parked.vehicle_id.tolist() == list(range(21, 21 + len(parked.vehicle_id)))
    for row, vehicle_id in enumerate(parked.vehicle_id.tolist()):
        model = by_name[traffic.models[vehicle_id]]
        assert model.parks
        offset_m = slots[:, :2] - [parked.x_m[row], parked.y_m[row]]
        nearest = int(np.argmin(np.linalg.norm(offset_m, axis=1)))
        cos, sin = np.cos(slots[nearest, 2]), np.sin(slots[nearest, 2])
        along_m, aside_m = offset_m[nearest] @ [cos, sin], offset_m[nearest] @ [-sin, cos]
        assert abs(along_m) + model.size_m[0] / 2 <= 6.2 / 2
        assert abs(aside_m) <= 0.1 + 1e-9


def test_stopped_at_red_the_first_vehicle_waits_before_the_line(traffic: Traffic, frames: list[TrafficFrame]) -> None:
    """Nobody enters a signalised junction while its approach shows red."""
    fronts = as_array(frames)
    entered = 0
    for before, after, frame in zip(fronts[:-1], fronts[1:], frames[:-1], strict=True):
        for signal in LAYOUT.signals:
            junction = LAYOUT.junctions[signal.junction_id]
            heading = np.array([np.cos(signal.heading_rad), np.sin(signal.heading_rad)])
            ahead_m = (np.array([junction.x_m, junction.y_m]) - before[:, :2]) @ heading
            aside_m = (before[:, :2] - [junction.x_m, junction.y_m]) @ [heading[1], -heading[0]]
            ahead_after_m = (np.array([junction.x_m, junction.y_m]) - after[:, :2]) @ heading
            along = np.cos(before[:, 2] - signal.heading_rad) > 0.99
            # the middle of a body passes the line: it entered at most a length and a yellow phase ago
            passing = along & (np.abs(aside_m - 3.5) < 3.5) & (ahead_m > 12.5) & (ahead_after_m <= 12.5)
            for vehicle in np.flatnonzero(passing):
                recent = frames[max(0, frame.index - 60) : frame.index + 1]
                entered += 1
                assert any(one.lamps[signal.junction_id, signal.approach] != "red" for one in recent), vehicle
    assert entered > 5


def test_the_seed_decides(
    traffic: Traffic, models: tuple[VehicleModel, ...], frames: list[TrafficFrame], tmp_path: Path
) -> None:
    again = simulate_traffic(LAYOUT, models, CONFIG, tmp_path)
    assert again.models == traffic.models
    assert again.ego_id == traffic.ego_id
    assert as_array(list(again.frames())).tobytes() == as_array(frames).tobytes()
    assert again.parked.x_m.tobytes() == traffic.parked.x_m.tobytes()


def test_slower_frames_are_every_nth_step(models: tuple[VehicleModel, ...], tmp_path: Path) -> None:
    """Five frames a second: SUMO still takes steps of 0.1 s."""
    slow = simulate_traffic(LAYOUT, models, dataclasses.replace(CONFIG, frames=10, period_ms=200), tmp_path)
    found = as_array(list(slow.frames()))
    step_m = np.linalg.norm(np.diff(found[..., :2], axis=0), axis=2)
    assert np.abs(step_m - (found[1:, :, 3] + found[:-1, :, 3]) / 2 * 0.2).max() < 0.7
    assert len(found) == 10


def test_more_vehicles_than_fit_are_refused(models: tuple[VehicleModel, ...], tmp_path: Path) -> None:
    with pytest.raises(SimulationError, match="found no room in the town"):
        simulate_traffic(LAYOUT, models, dataclasses.replace(CONFIG, vehicles=1500, frames=1), tmp_path)


def test_sumo_s_own_words_are_passed_on(tmp_path: Path) -> None:
    with pytest.raises(SimulationError, match=r"SUMO's netconvert ended with code \d+: .*absent"):
        run_sumo("netconvert", {"node-files": str(tmp_path / "absent"), "edge-files": str(tmp_path / "absent")})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"vehicles": 0}, "vehicles must be at least 1, not 0"),
        ({"frames": 0}, "frames must be at least 1"),
        ({"seed": -1}, "seed must be at least 0"),
        ({"parked_share": 1.5}, "parked_share must lie between 0 and 1"),
    ],
)
def test_settings_out_of_range_are_refused(change: dict[str, float], message: str) -> None:
    with pytest.raises(SimulationError, match=message):
        dataclasses.replace(CONFIG, **change)
