"""Clouds of the drive that ships, and how they are kept."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from labeler.drive import open_drive
from labeler.models import SHIPPED, Task
from labeler.segmentation import Segmenter, open_segmenter
from labeler.simulation.sample import sample_drive
from labeler.training.clouds import DirectionSweep, direction_sweeps, load_clouds, points_inside
from labeler.training.errors import TrainingError


@pytest.fixture(scope="module")
def segmenter() -> Segmenter:
    file = next(model.path for model in SHIPPED if model.task is Task.SEGMENTATION)
    return open_segmenter(file, providers=("CPUExecutionProvider",))


@pytest.fixture(scope="module")
def sweeps(segmenter: Segmenter) -> list[DirectionSweep]:
    """The four directions of one moment."""
    drive = open_drive(sample_drive())
    return list(direction_sweeps(replace(drive, frames=drive.frames[20:21]), segmenter))


def test_every_camera_has_its_direction_with_the_same_vehicles_around_it(sweeps: list[DirectionSweep]) -> None:
    front, left, rear, right = sweeps
    assert {len(sweep.truth) for sweep in sweeps} == {len(front.truth)}
    # Opposite cameras stand .45 m off the middle of the roof, each to its own side.
    for one, other in ((front, rear), (left, right)):
        np.testing.assert_allclose(one.truth[:, :2] + other.truth[:, :2], [[-0.9, 0]] * len(one.truth), atol=0.02)
    np.testing.assert_allclose(front.reach_rad, np.radians([-50, 50]), atol=1e-3)


def test_vehicles_that_are_asked_for_hold_points_painted_as_vehicles(sweeps: list[DirectionSweep]) -> None:
    asked = 0
    for sweep in sweeps:
        cloud = sweep.cloud()
        for box in sweep.truth[sweep.asked]:
            inside = points_inside(cloud[:, :3], box, 0.1)
            assert inside.sum() >= 3
            asked += 1
        seen = cloud[:, 4] > 0.5
        on_vehicles = np.zeros(len(cloud), np.bool_)
        for box in sweep.truth:
            on_vehicles |= points_inside(cloud[:, :3], box, 0.1)
        if (seen & on_vehicles).sum() > 50:
            assert cloud[seen & on_vehicles, 5].mean() > 0.5
            assert cloud[seen & ~on_vehicles, 5].mean() < 0.2
    assert asked >= 4


def test_a_drive_is_painted_once(segmenter: Segmenter, tmp_path: Path) -> None:
    drive = one_frame(tmp_path / "drive")
    lines: list[str] = []
    first = load_clouds([drive], segmenter, tmp_path / "clouds", painter="a", report=lines.append)
    again = load_clouds([drive], segmenter, tmp_path / "clouds", painter="a", report=lines.append)
    assert lines == ["painting drive 1 of 1: drive"]
    for one, other in zip(first, again, strict=True):
        for name in vars(one):
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    load_clouds([drive], segmenter, tmp_path / "clouds", painter="another", report=lines.append)
    assert len(lines) == 2
    assert len(list((tmp_path / "clouds").iterdir())) == 2


def test_what_cannot_be_used_is_said(segmenter: Segmenter, tmp_path: Path) -> None:
    drive = one_frame(tmp_path / "drive")
    load_clouds([drive], segmenter, tmp_path / "clouds", painter="a", report=print)
    (kept,) = (tmp_path / "clouds").iterdir()
    kept.write_bytes(kept.read_bytes()[:100])
    with pytest.raises(TrainingError, match=r"can't be read: .* Delete it"):
        load_clouds([drive], segmenter, tmp_path / "clouds", painter="a", report=print)
    (tmp_path / "file").touch()
    with pytest.raises(TrainingError, match="can't be written"):
        load_clouds([drive], segmenter, tmp_path / "file", painter="a", report=print)
    (drive / "annotations.feather").unlink()
    with pytest.raises(TrainingError, match="no true 3D boxes"):
        load_clouds([drive], segmenter, tmp_path / "clouds", painter="a", report=print)


def one_frame(folder: Path) -> Path:
    """A copy, by links, of one moment of the drive that ships, with all of its truth."""
    source = sample_drive()
    sweep = sorted((source / "sensors" / "lidar").iterdir())[10]
    wanted = [file for file in source.rglob("*.feather") if "sensors" not in file.parts]
    wanted += [sweep, *source.glob(f"sensors/cameras/*/{sweep.stem}.jpg")]
    for file in wanted:
        link = folder / file.relative_to(source)
        link.parent.mkdir(parents=True, exist_ok=True)
        link.symlink_to(file)
    return folder
