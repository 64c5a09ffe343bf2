"""A whole simulated drive, as small as it gets: one interrupted and resumed, one in one go."""

import dataclasses
import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from labeler.drive import Drive, open_drive
from labeler.drive.images import read_image
from labeler.drive.types import TruthBoxes2D, TruthBoxes3D
from labeler.geometry.boxes_3d import corners_of
from labeler.geometry.projection import project_points
from labeler.simulation.errors import SimulationError
from labeler.simulation.graphics import open_context
from labeler.simulation.materials import Semantic
from labeler.simulation.recording import SimulationConfig, simulate_drive

for module, package in (("sumo", "eclipse-sumo"), ("embreex", "embreex"), ("moderngl", "moderngl")):
    pytest.importorskip(module, reason=f"needs {package}, of the extra `simulation`")

CONFIG = SimulationConfig(
    seed=114,
    frames=2,
    vehicles=20,
    width_px=240,
    height_px=120,
    town="grid-small",
    lidar_channels=32,
    lidar_columns=720,
    semantic=True,
)


class Listener:
    """Keeps what it is told, and presses Ctrl-C after some moments."""

    def __init__(self, stop_after: int | None = None) -> None:
        self.stages: list[tuple[str, int]] = []
        self._left = stop_after

    def stage(self, name: str, units: int) -> None:
        self.stages.append((name, units))

    def advance(self, units: int = 1) -> None:
        if self._left is not None and self.stages[-1][0] == "Recording moments":
            self._left -= units
            if self._left == 0:
                raise KeyboardInterrupt


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Stopped after the first moment, and gone on with."""
    try:
        open_context().release()
    except SimulationError as error:
        pytest.skip(f"needs OpenGL: {error}")
    folder = tmp_path_factory.mktemp("simulated") / "drive"
    with pytest.raises(KeyboardInterrupt):
        simulate_drive(folder, CONFIG, Listener(stop_after=1))
    assert not folder.exists()
    listener = Listener()
    simulate_drive(folder, CONFIG, listener)
    assert listener.stages[-1] == ("Recording moments", 1)
    assert [path.name for path in folder.parent.iterdir()] == ["drive"]
    return folder


@pytest.fixture(scope="module")
def drive(recorded: Path) -> Drive:
    return open_drive(recorded)


@pytest.fixture(scope="module")
def truth(drive: Drive) -> tuple[TruthBoxes2D, TruthBoxes3D]:
    truth = drive.read_truth(drive.frames)
    assert truth is not None
    assert truth.boxes_2d is not None
    assert truth.boxes_3d is not None
    return truth.boxes_2d, truth.boxes_3d


def test_the_same_seed_gives_the_same_bytes(recorded: Path, tmp_path: Path) -> None:
    """Also when one of the two was interrupted."""
    simulate_drive(tmp_path / "again", CONFIG, Listener())
    files = sorted(path.relative_to(recorded) for path in recorded.rglob("*.*") if path.is_file())
    # Four images, their classes and a sweep a moment; two calibrations, poses, two truths, settings.
    assert len(files) == 2 * 9 + 6
    assert [file for file in files if (recorded / file).read_bytes() != (tmp_path / "again" / file).read_bytes()] == []


def test_it_opens_without_a_warning(drive: Drive) -> None:
    assert (drive.format, drive.warnings, len(drive.frames)) == ("argoverse2", (), 2)
    assert {camera.name for camera in drive.cameras} == {"front", "left", "right", "rear"}
    for frame in drive.frames:
        assert set(frame.images) == {"front", "left", "right", "rear"}
        for camera in drive.cameras:
            image = read_image(frame.images[camera.name], camera)
            assert image.std() > 10


def test_it_says_what_it_was_made_from(recorded: Path) -> None:
    about = json.loads((recorded / "simulation.json").read_text("utf-8"))
    assert about["settings"]["seed"] == 114
    assert about["simulation_version"] == 1
    assert set(about["made_with"]) == {"hindsight-labeler", "eclipse-sumo", "embreex", "moderngl"}


def test_whole_boxes_lie_within_the_projected_3d_boxes(drive: Drive, truth: tuple[TruthBoxes2D, TruthBoxes3D]) -> None:
    """Images, 3D truth, poses and calibration agree: a vehicle's outline fills its projected 3D box almost."""
    in_2d, in_3d = truth
    objects = zip(in_3d.frame_index.tolist(), in_3d.track_uuid, strict=True)
    row_of = {one: row for row, one in enumerate(objects)}
    compared = 0
    for row, camera_name in enumerate(in_2d.camera):
        match = row_of.get((int(in_2d.frame_index[row]), in_2d.track_uuid[row]))
        calibration = drive.camera(camera_name).calibration
        assert calibration is not None
        if match is None:
            continue
        corners_m = corners_of(in_3d.center_m[match][None], in_3d.size_m[match][None], in_3d.yaw_rad[match][None])[0]
        pixels, depth_m = project_points(corners_m, calibration.ego_SE3_camera, calibration.intrinsics)
        if depth_m.min() < 1:
            continue
        around = np.concatenate([pixels.min(axis=0), pixels.max(axis=0)])
        around = np.clip(around, 0, [240, 120, 240, 120])
        box = in_2d.xyxy_px[row]
        assert (box[:2] >= around[:2] - 1).all()
        assert (box[2:] <= around[2:] + 1).all()
        filled = (box[2] - box[0]) * (box[3] - box[1]) / np.prod(np.maximum(around[2:] - around[:2], 1))
        if (box[2] - box[0]) > 20 and around[0] > 0 and around[2] < 240 and around[3] < 120:
            assert filled > 0.5
            compared += 1
    assert compared >= 5


def test_visible_boxes_lie_in_whole_ones(truth: tuple[TruthBoxes2D, TruthBoxes3D]) -> None:
    in_2d, _ = truth
    assert in_2d.visible_xyxy_px is not None
    assert in_2d.visible_share is not None
    assert in_2d.visible_pixels is not None
    assert (in_2d.visible_xyxy_px[:, :2] >= in_2d.xyxy_px[:, :2]).all()
    assert (in_2d.visible_xyxy_px[:, 2:] <= in_2d.xyxy_px[:, 2:]).all()
    assert (in_2d.visible_pixels >= 1).all()
    assert ((in_2d.visible_share >= 0) & (in_2d.visible_share <= 1)).all()
    in_full_view = in_2d.visible_share == 1
    off_px = np.abs(in_2d.visible_xyxy_px - in_2d.xyxy_px)[in_full_view]
    assert len(off_px) >= 4
    assert np.median(off_px) < 1


def test_pixels_of_vehicles_are_as_many_as_the_truth_counts(
    recorded: Path, drive: Drive, truth: tuple[TruthBoxes2D, TruthBoxes3D]
) -> None:
    """The class of each pixel and the visible pixels of each vehicle come from one and the same drawing."""
    boxes, _ = truth
    assert boxes.visible_pixels is not None
    shown = 0
    for frame in drive.frames:
        for camera, file in frame.images.items():
            classes = cv2.imread(str(recorded / "semantic" / camera / f"{file.timestamp_ns}.png"), cv2.IMREAD_UNCHANGED)
            assert classes is not None
            assert classes.shape == (120, 240)
            of_image = (boxes.frame_index == frame.index) & (np.array(boxes.camera) == camera)
            assert np.count_nonzero(classes == Semantic.VEHICLE) == boxes.visible_pixels[of_image].sum()
            assert np.count_nonzero(classes == Semantic.ROAD) > 0.05 * classes.size
            shown += int(of_image.sum())
    assert shown > 10


def test_points_lie_in_the_boxes_of_what_is_near(drive: Drive, truth: tuple[TruthBoxes2D, TruthBoxes3D]) -> None:
    in_2d, in_3d = truth
    assert in_2d.visible_share is not None
    assert in_2d.distance_m is not None
    shown = (in_2d.frame_index == 0) & (in_2d.visible_share > 0.5) & (in_2d.distance_m < 20)
    uuids = {in_2d.track_uuid[row] for row in np.flatnonzero(shown)}
    sweep_file = drive.frames[0].sweep
    assert sweep_file is not None
    xyz_m = drive.read_sweep(sweep_file).xyz_m.astype(np.float64)
    rows = [row for row in np.flatnonzero(in_3d.frame_index == 0) if in_3d.track_uuid[row] in uuids]
    assert len(rows) >= 2
    for row in rows:
        cos, sin = np.cos(in_3d.yaw_rad[row]), np.sin(in_3d.yaw_rad[row])
        off_m = xyz_m - in_3d.center_m[row]
        ahead_m, aside_m = cos * off_m[:, 0] + sin * off_m[:, 1], cos * off_m[:, 1] - sin * off_m[:, 0]
        local_m = np.stack([ahead_m, aside_m, off_m[:, 2]], axis=1)
        assert (np.abs(local_m) <= in_3d.size_m[row] / 2 + 0.1).all(axis=1).sum() > 30


def test_no_point_lies_below_the_ground_or_beyond_the_range(drive: Drive) -> None:
    for frame in drive.frames:
        assert frame.sweep is not None
        xyz_m = drive.read_sweep(frame.sweep).xyz_m
        assert len(xyz_m) > 8000
        assert xyz_m[:, 2].min() > -0.2
        assert np.linalg.norm(xyz_m, axis=1).max() < 103


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"rate_hz": 0.1}, "The rate must lie between 0.5 and 50"),
        ({"width_px": 10}, "Images must have sides of 64 to 4096 pixels, not 10 x 120"),
        ({"jpeg_quality": 0}, "The JPEG quality must lie between 1 and 100"),
        ({"lidar_channels": 16}, "at least 32 channels"),
        ({"frames": 0}, "frames must be at least 1"),
        ({"town": "atlantis"}, "there is no town called 'atlantis'"),
        ({"light": "moonlight"}, "there is no light called 'moonlight'"),
    ],
)
def test_settings_out_of_range_are_refused(change: dict[str, Any], message: str) -> None:
    with pytest.raises(SimulationError, match=message):
        dataclasses.replace(CONFIG, **change)


def test_a_folder_that_is_there_is_refused_at_once(tmp_path: Path) -> None:
    listener = Listener()
    with pytest.raises(SimulationError, match="is there already"):
        simulate_drive(tmp_path, CONFIG, listener)
    assert listener.stages == []
