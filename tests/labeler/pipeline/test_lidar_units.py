"""What the LiDAR step writes where sweeps, or the LiDAR, are missing, or a camera is turned."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from labeler.drive import Drive, Frame, Poses, SweepFile, open_drive
from labeler.geometry.se3 import se3
from labeler.lidar import Agreement, PositionSource
from labeler.pipeline import label_drive
from labeler.pipeline.lidar_units import agreement_of, boxes_of, lidar_frame, positions_of
from labeler.pipeline.tables import Columns, read_batches


def located(drive: Drive, model: Path, workspace: Path) -> Columns:
    """The table of the LiDAR step, of a drive of one clip."""
    label_drive(drive, model=model, workspace=workspace)
    (path,) = (workspace / "artifacts" / "lidar").iterdir()
    (columns,) = read_batches(path)
    return columns


def test_a_frame_without_a_sweep_borrows_the_nearest_one(made_drive: Path, made_model: Path, tmp_path: Path) -> None:
    folder = tmp_path / "gap"
    shutil.copytree(made_drive, folder)
    sweeps = sorted((folder / "sensors" / "lidar").iterdir())
    for sweep in sweeps[5:7]:
        sweep.unlink()
    drive = open_drive(folder)
    bare = [frame.index for frame in drive.frames if frame.sweep is None]
    assert len(bare) == 2
    columns = located(drive, made_model, tmp_path / "workspace")
    for frame, offset_s in zip(bare, (-0.1, 0.1), strict=True):
        rows = {name: column[columns["frame_index"] == frame] for name, column in columns.items()}
        assert len(boxes_of(rows)) > 0
        np.testing.assert_allclose(boxes_of(rows).offset_s, offset_s, atol=1e-3)


def test_without_lidar_every_detection_stands_where_its_height_says(
    made_drive: Path, made_model: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "no lidar"
    shutil.copytree(made_drive, folder)
    shutil.rmtree(folder / "sensors" / "lidar")
    columns = located(open_drive(folder), made_model, tmp_path / "workspace")
    assert len(boxes_of(columns)) == 0
    positions = positions_of(columns)
    assert len(positions) > 20
    assert set(positions.position_source.tolist()) == {PositionSource.HEIGHT}
    distance_m = np.hypot(positions.position_m[:, 0], positions.position_m[:, 1])
    assert 8 < np.median(distance_m) < 20  # the cars stand 12 m away


def test_with_lidar_the_positions_are_the_centres_of_the_boxes(
    made_drive: Path, made_model: Path, tmp_path: Path
) -> None:
    columns = located(open_drive(made_drive), made_model, tmp_path)
    boxes, positions = boxes_of(columns), positions_of(columns)
    boxed = positions[positions.position_source == PositionSource.BOX]
    np.testing.assert_array_equal(boxed.position_m, boxes.center_m)
    (path,) = (tmp_path / "artifacts" / "lidar").iterdir()
    assert all(isinstance(found, Agreement) for found in agreement_of([path]).values())


@pytest.mark.parametrize(
    ("with_poses", "moved_m"),
    [
        (True, 1.0),  # at 10 m/s, the sweep of 0.1 s later was taken 1 m ahead
        (False, 0.0),  # nobody knows
    ],
)
def test_the_cars_motion_between_a_borrowed_sweep_and_the_frame_is_taken_out(with_poses: bool, moved_m: float) -> None:
    times = np.array([0, 1_000_000_000])
    poses = Poses(times, np.stack([se3(np.eye(3), [0, 0, 0]), se3(np.eye(3), [10, 0, 0])]))
    frame = Frame(0, 200_000_000, {}, None)
    borrowed = lidar_frame(frame, SweepFile(300_000_000, Path("none")), poses if with_poses else None)
    np.testing.assert_allclose(borrowed.frame_ego_SE3_sweep_ego[:3, 3], [moved_m, 0, 0], atol=1e-9)
