"""A whole recording from a fake server, read back by the project's own reader."""

import json
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from labeler.carla.config import CarlaConfig
from labeler.carla.errors import CarlaError
from labeler.carla.recording import Recorded, record_drive
from labeler.drive.registry import open_drive
from labeler.drive.types import Drive, Truth, TruthBoxes2D, TruthBoxes3D
from labeler.geometry.boxes_3d import corners_of
from labeler.geometry.projection import project_points
from labeler.simulation.errors import SimulationError
from tests.labeler.carla.fake_carla import Blueprints, Location, Rotation, Server, Settings, Transform, module_of

pytest.importorskip("embreex", reason="needs embreex, of the extras `carla` and `simulation`")

SMALL = CarlaConfig(
    vehicles=3, frames=3, width_px=240, height_px=120, lidar_channels=24, lidar_columns=180, warm_up_s=0.3, timeout_s=5
)
TINY = replace(SMALL, width_px=64, height_px=64, lidar_channels=4, lidar_columns=90)
OLD_WORLD = (Settings(), "storm", {}, set[int](), False)


class Silent:
    def stage(self, name: str, units: int) -> None: ...
    def advance(self, units: int = 1) -> None: ...


class After(Silent):
    """Calls something once that many moments are recorded."""

    def __init__(self, moments: int, do: Callable[[], None]) -> None:
        self._left, self._do = moments, do

    def stage(self, name: str, units: int) -> None:
        self._recording = name.startswith("Recording")

    def advance(self, units: int = 1) -> None:
        if self._recording:
            self._left -= units
            if self._left == 0:
                self._do()


def stop() -> None:
    raise KeyboardInterrupt


def state_of(server: Server) -> Any:
    return server.settings, server.weather, server.actors, server.hidden_scenery, server.traffic_synchronous


def server_of(version: str = "0.9.16") -> Server:
    """Room for three vehicles, 20 m and more apart, so that none hides another, nor the ego car's own body one."""
    made = Server(version)
    made.spawn_points = [
        Transform(Location(50.0, 20.0, 0.0), Rotation(yaw=40.0)),
        Transform(Location(66.0, 33.0, 0.0), Rotation(yaw=10.0)),
        Transform(Location(35.0, 38.0, 0.0), Rotation(yaw=120.0)),
    ]
    return made


@pytest.fixture
def server() -> Iterator[Server]:
    made = server_of()
    yield made
    made.close()


@pytest.fixture(scope="module")
def recorded_drive(tmp_path_factory: pytest.TempPathFactory) -> Drive:
    """A drive that is only read."""
    server, folder = server_of(), tmp_path_factory.mktemp("carla") / "drive"
    record(server, folder, SMALL)
    server.close()
    return open_drive(folder)


def record(server: Server, folder: Path, config: CarlaConfig = TINY, progress: Any = None) -> Recorded:
    return record_drive(module_of(server), folder, config, progress or Silent())


def truth_of(drive: Drive) -> tuple[TruthBoxes2D, TruthBoxes3D]:
    truth = drive.read_truth(drive.frames)
    assert isinstance(truth, Truth)
    assert truth.boxes_2d is not None
    assert truth.boxes_3d is not None
    return truth.boxes_2d, truth.boxes_3d


def test_the_drive_opens(server: Server, tmp_path: Path) -> None:
    recorded = record(server, tmp_path / "drive")
    drive = open_drive(tmp_path / "drive")
    assert (recorded.moments, recorded.warnings, drive.warnings) == (3, (), ())
    assert drive.format == "argoverse2"
    assert [camera.name for camera in drive.cameras] == ["front", "left", "rear", "right"]
    assert {(camera.width_px, camera.height_px) for camera in drive.cameras} == {(64, 64)}
    assert [len(frame.images) for frame in drive.frames] == [4, 4, 4]
    assert np.diff([frame.timestamp_ns for frame in drive.frames]).tolist() == [100_000_000, 100_000_000]
    about = json.loads((tmp_path / "drive" / "simulation.json").read_text("utf-8"))
    assert about["recorded_from"] == "CARLA 0.9.16"
    assert [entry.name for entry in tmp_path.iterdir()] == ["drive"]


def test_3d_boxes_project_onto_the_pixels_that_show_them(recorded_drive: Drive) -> None:
    """The fake drew the images in left-handed frames; the drive's boxes, poses and calibration must lead back there."""
    drive = recorded_drive
    in_2d, in_3d = truth_of(drive)
    assert in_2d.visible_xyxy_px is not None
    corners_m = corners_of(in_3d.center_m, in_3d.size_m, in_3d.yaw_rad)
    rows = list(zip(in_3d.frame_index.tolist(), in_3d.track_uuid, strict=True))
    compared = 0
    for row, visible_px in enumerate(in_2d.visible_xyxy_px):
        camera = drive.camera(in_2d.camera[row])
        inside = visible_px[0] > 0 and visible_px[2] < camera.width_px
        if not inside or camera.calibration is None:
            continue
        box = rows.index((int(in_2d.frame_index[row]), in_2d.track_uuid[row]))
        pixels, _ = project_points(corners_m[box], camera.calibration.ego_SE3_camera, camera.calibration.intrinsics)
        projected = [*pixels.min(axis=0), *pixels.max(axis=0)]
        assert visible_px == pytest.approx(projected, abs=1.0)
        assert in_2d.xyxy_px[row] == pytest.approx(projected, abs=1.0)
        image = cv2.imread(str(drive.frames[int(in_2d.frame_index[row])].images[camera.name].path))
        assert image is not None
        middle = image[int(visible_px[[1, 3]].mean()), int(visible_px[[0, 2]].mean())]
        assert middle[2] > 150, "the vehicle is red in the image"
        compared += 1
    assert compared >= 6


def test_sweeps_lie_on_the_ground_and_on_vehicles(recorded_drive: Drive) -> None:
    drive = recorded_drive
    _, in_3d = truth_of(drive)
    sweep_file = drive.frames[0].sweep
    assert sweep_file is not None
    xyz_m = drive.read_sweep(sweep_file).xyz_m
    on_ground = np.abs(xyz_m[:, 2]) < 0.05
    for row in np.flatnonzero(in_3d.frame_index == 0).tolist():
        center_m, size_m, yaw_rad = in_3d.center_m[row], in_3d.size_m[row], in_3d.yaw_rad[row]
        turn = np.array([[np.cos(yaw_rad), np.sin(yaw_rad), 0], [-np.sin(yaw_rad), np.cos(yaw_rad), 0], [0, 0, 1]])
        on_vehicle = (np.abs((xyz_m - center_m) @ turn.T) <= size_m / 2 + 0.05).all(axis=1)
        assert np.count_nonzero(on_vehicle) >= 5
        on_ground |= on_vehicle
    assert on_ground.all()
    assert (np.abs(xyz_m[:, :2]) > [2.4, 1.1]).any(axis=1).all(), "no point on the own car"


def test_poses_follow_the_ego_car(recorded_drive: Drive) -> None:
    """2 m/s for 0.1 s each along its own x axis, from one of the places where vehicles can start."""
    poses = recorded_drive.poses
    assert poses is not None
    steps = np.diff(poses.city_SE3_ego[:, :3, 3], axis=0)
    assert np.linalg.norm(steps, axis=1) == pytest.approx([0.2, 0.2])
    assert steps[0] / 0.2 == pytest.approx(poses.city_SE3_ego[0, :3, 0])
    starts = [(point.location.x, -point.location.y) for point in server_of().spawn_points]
    assert min(np.hypot(*(poses.city_SE3_ego[0, :2, 3] - start)) for start in starts) < 2


@pytest.mark.parametrize("version", ["0.9.12", "0.9.15"])
def test_older_servers_give_the_same_boxes(recorded_drive: Drive, tmp_path: Path, version: str) -> None:
    """Without actors' numbers in the instance camera, visible parts come from depth and semantics."""
    older = server_of(version)
    record(older, tmp_path / "old", SMALL)
    older.close()
    (new, _), (old, _) = truth_of(recorded_drive), truth_of(open_drive(tmp_path / "old"))
    assert old.visible_xyxy_px is not None
    assert new.visible_xyxy_px is not None
    assert old.camera == new.camera
    assert old.visible_xyxy_px.tolist() == new.visible_xyxy_px.tolist()


def test_the_world_is_left_as_it_was(server: Server, tmp_path: Path) -> None:
    record(server, tmp_path / "drive")
    assert state_of(server) == OLD_WORLD


def test_vehicles_of_others_stay_and_have_truth(server: Server, tmp_path: Path) -> None:
    other = server.spawn(Blueprints().find("vehicle.mitsubishi.fusorosa"), Transform(Location(70.0, 20.0)))
    record(server, tmp_path / "drive")
    assert list(server.actors) == [other.id]
    assert "BUS" in truth_of(open_drive(tmp_path / "drive"))[1].category


def test_what_the_world_is_while_recording(server: Server, tmp_path: Path) -> None:
    seen: list[Any] = []
    record(server, tmp_path / "drive", progress=After(1, lambda: seen.append((*state_of(server), dict(server.actors)))))
    settings, weather, _, hidden, traffic_synchronous, actors = seen[0]
    assert (settings.synchronous_mode, settings.fixed_delta_seconds) == (True, 0.1)
    assert settings.max_substeps * settings.max_substep_delta_time == pytest.approx(0.1)
    assert (weather, hidden, traffic_synchronous) == ("clear noon", {7001, 7002, 7003}, True)
    vehicles = [actor for actor in actors.values() if actor.type_id.startswith("vehicle.")]
    assert [vehicle.autopilot for vehicle in vehicles] == [8000, 8000, 8000]
    assert [vehicle.attributes["role_name"] for vehicle in vehicles] == ["hero", "autopilot", "autopilot"]
    assert {vehicle.type_id for vehicle in vehicles} <= {"vehicle.tesla.model3", "vehicle.mitsubishi.fusorosa"}
    assert len(actors) == 3 + 9


def test_ctrl_c_keeps_whole_moments_and_restores_the_world(server: Server, tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        record(server, tmp_path / "drive", progress=After(2, stop))
    assert len(open_drive(tmp_path / "drive").frames) == 2
    assert state_of(server) == OLD_WORLD


def test_ctrl_c_carries_what_could_not_be_undone(server: Server, tmp_path: Path) -> None:
    server.fail_at_frame, server.error = 45, KeyboardInterrupt()
    server.broken_calls = ("destroy sensor.lidar.ray_cast",)
    with pytest.raises(KeyboardInterrupt, match=r"sensor\.lidar\.ray_cast \d+ is still there \(rpc::timeout\)"):
        record(server, tmp_path / "drive")


def test_ctrl_c_before_the_first_moment_leaves_nothing(server: Server, tmp_path: Path) -> None:
    server.fail_at_frame, server.error = 42, KeyboardInterrupt()
    with pytest.raises(KeyboardInterrupt):
        record(server, tmp_path / "drive")
    assert list(tmp_path.iterdir()) == []
    assert state_of(server) == OLD_WORLD


def test_a_server_that_fails(server: Server, tmp_path: Path) -> None:
    """3 ticks to warm up, 2 to settle, 1 moment; the next tick times out."""
    server.fail_at_frame = server.frame + 7
    with pytest.raises(CarlaError, match=r"CARLA failed: time-out of 60000ms.* The 1 moments recorded until then"):
        record(server, tmp_path / "drive")
    assert len(open_drive(tmp_path / "drive").frames) == 1
    assert state_of(server) == OLD_WORLD


def test_a_silent_sensor_is_named(server: Server, tmp_path: Path) -> None:
    server.silent_sensor = "lidar"
    config = CarlaConfig(vehicles=1, frames=1, width_px=64, height_px=64, warm_up_s=0, timeout_s=0.2)
    with pytest.raises(CarlaError, match=r"of lidar \(nothing yet\) within 0.2 s"):
        record(server, tmp_path / "drive", config)
    assert list(tmp_path.iterdir()) == []
    assert state_of(server) == OLD_WORLD


def test_what_cannot_be_restored_is_told_and_the_rest_is_restored(server: Server, tmp_path: Path) -> None:
    def break_weather() -> None:
        server.broken_calls = ("set_weather", "destroy sensor.lidar.ray_cast")

    recorded = record(server, tmp_path / "drive", progress=After(3, break_weather))
    (warning,) = recorded.warnings
    assert "the weather is clear (rpc::timeout)" in warning
    assert "sensor.lidar.ray_cast" in warning
    assert server.settings == Settings()
    assert [actor.type_id for actor in server.actors.values()] == ["sensor.lidar.ray_cast"]


def test_another_town_is_loaded(server: Server, tmp_path: Path) -> None:
    server.towns, town = ("Town01", "Town10HD_Opt"), "Town10HD_Opt"
    hidden: list[set[int]] = []
    config = CarlaConfig(town=town, vehicles=1, frames=1, width_px=64, height_px=64, warm_up_s=0, timeout_s=5)
    record(server, tmp_path / "drive", config, After(1, lambda: hidden.append(set(server.hidden_scenery))))
    assert server.town == town
    assert hidden == [{-1, 7001, 7002, 7003}]  # -1 is the layer of parked vehicles
    assert server.hidden_scenery == set()


@pytest.mark.parametrize(
    ("config", "words"),
    [
        (CarlaConfig(town="Town99"), "no town Town99. It has Town01, Town10HD"),
        (CarlaConfig(vehicles=4), "room for 3 vehicles now, not for 4"),
    ],
)
def test_what_the_server_does_not_have(server: Server, tmp_path: Path, config: CarlaConfig, words: str) -> None:
    with pytest.raises(CarlaError, match=words):
        record(server, tmp_path / "drive", config)
    assert state_of(server) == OLD_WORLD


def test_a_folder_that_is_there_is_not_touched(server: Server, tmp_path: Path) -> None:
    with pytest.raises(SimulationError, match="is there already"):
        record(server, tmp_path)
    assert server.frame == 40


def test_a_place_that_cannot_be_written(server: Server, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder", encoding="utf-8")
    with pytest.raises(CarlaError, match=r"drive can't be written \(.*Not a directory.*record again"):
        record(server, tmp_path / "file" / "drive")
    assert state_of(server) == OLD_WORLD


def test_without_embreex_the_server_is_not_touched(
    server: Server, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "embreex.rtcore_scene", None)
    with pytest.raises(CarlaError, match=r"embreex.*hindsight-labeler\[carla\]"):
        record(server, tmp_path / "drive")
    assert server.frame == 40


@pytest.mark.parametrize(
    "wrong", [{"frames": 0}, {"vehicles": 0}, {"interval_s": 0.3}, {"interval_s": 0.0}, {"lidar_channels": 256}]
)
def test_settings_that_make_no_sense(wrong: dict[str, Any]) -> None:
    with pytest.raises(CarlaError):
        CarlaConfig(**wrong)


def test_the_defaults_are_the_papers() -> None:
    paper = CarlaConfig()
    assert (paper.town, paper.vehicles, paper.frames, paper.interval_s) == ("Town10HD", 60, 1000, 0.1)
    assert (paper.width_px, paper.height_px, paper.distance_m) == (720, 360, 80.0)
