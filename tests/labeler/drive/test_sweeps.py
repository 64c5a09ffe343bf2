"""Checks that all sweep readers share."""

import pickle
from pathlib import Path

import numpy as np
import pytest

from labeler.drive.errors import DriveFileError
from labeler.drive.kitti import KittiSweepReader
from labeler.drive.nuscenes import NuscenesSweepReader
from labeler.drive.sweeps import checked_sweep
from labeler.drive.types import SweepFile, SweepReader
from labeler.geometry.se3 import se3

_NAN, _INF = float("nan"), float("inf")


@pytest.mark.parametrize(
    ("x_m", "kept"),
    [
        ([1, 2, 3, 4], [1, 2, 3, 4]),  # all good
        ([1, _NAN, 3, 4], [1, 3, 4]),  # not a number
        ([_INF, 2, 3, -_INF], [2, 3]),  # infinite; half of the points may be bad
        ([], []),  # an empty sweep is valid
    ],
)
def test_points_that_are_not_finite_are_dropped(x_m: list[float], kept: list[float]) -> None:
    xyz_m = np.zeros((len(x_m), 3), dtype=np.float32)
    xyz_m[:, 1] = x_m
    sweep = checked_sweep(SweepFile(5, Path("a.bin")), xyz_m, np.arange(len(x_m), dtype=np.float32))
    assert sweep.xyz_m[:, 1].tolist() == kept
    assert len(sweep.intensity) == len(kept)
    assert sweep.timestamp_ns == 5


def test_a_sweep_with_more_than_half_bad_points_is_refused() -> None:
    xyz_m = np.full((3, 3), _NAN, dtype=np.float32)
    xyz_m[0] = 1
    with pytest.raises(DriveFileError, match=r"a\.bin holds 2 of 3 points that are not finite"):
        checked_sweep(SweepFile(0, Path("a.bin")), xyz_m, np.zeros(3, dtype=np.float32))


def test_an_intensity_that_is_not_finite_is_0() -> None:
    intensity = np.array([0.5, _NAN], dtype=np.float32)
    assert checked_sweep(SweepFile(0, Path("a")), np.zeros((2, 3), np.float32), intensity).intensity.tolist() == [
        0.5,
        0,
    ]


def test_kitti_points_are_read_as_they_are(tmp_path: Path) -> None:
    path = tmp_path / "000001.bin"
    np.array([[1, 2, 3, 0.5], [4, 5, 6, 0.25]], dtype="<f4").tofile(path)
    sweep = KittiSweepReader()(SweepFile(7, path))
    assert sweep.xyz_m.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert sweep.intensity.tolist() == [0.5, 0.25]
    assert sweep.xyz_m.dtype == sweep.intensity.dtype == np.float32


def test_nuscenes_points_are_moved_into_the_ego_frame(tmp_path: Path) -> None:
    path = tmp_path / "a.pcd.bin"
    np.array([[10, 0, 0, 30, 1], [0, 20, 1, 40, 2]], dtype="<f4").tofile(path)
    # The LiDAR's x points to the ego's -y, and it stands 1 m ahead and 1 m up.
    sweep = NuscenesSweepReader(se3([[0, 1, 0], [-1, 0, 0], [0, 0, 1]], [1, 0, 1]))(SweepFile(7, path))
    assert sweep.xyz_m.tolist() == [[1, -10, 1], [21, 0, 2]]
    assert sweep.intensity.tolist() == [30, 40]
    assert sweep.xyz_m.dtype == np.float32


@pytest.mark.parametrize(
    ("reader", "size_bytes", "fine"),
    [
        (KittiSweepReader(), 0, True),  # no points
        (KittiSweepReader(), 32, True),  # two points of 16 bytes
        (KittiSweepReader(), 30, False),  # cut inside of a point
        (NuscenesSweepReader(np.eye(4)), 40, True),  # two points of 20 bytes
        (NuscenesSweepReader(np.eye(4)), 32, False),  # a KITTI file is none of nuScenes
    ],
)
def test_truncated_files_are_refused(tmp_path: Path, reader: SweepReader, size_bytes: int, *, fine: bool) -> None:
    path = tmp_path / "sweep.bin"
    path.write_bytes(bytes(size_bytes))
    if fine:
        assert np.count_nonzero(reader(SweepFile(0, path)).intensity) == 0
    else:
        with pytest.raises(DriveFileError, match=r"sweep\.bin is truncated"):
            reader(SweepFile(0, path))


def test_a_sweep_that_is_gone_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DriveFileError, match="can't be read"):
        KittiSweepReader()(SweepFile(0, tmp_path / "gone.bin"))


def test_readers_can_be_sent_to_worker_processes() -> None:
    reader = NuscenesSweepReader(se3(np.eye(3), [1, 2, 3]))
    assert pickle.loads(pickle.dumps(reader)).ego_SE3_lidar.tolist() == reader.ego_SE3_lidar.tolist()
    assert pickle.loads(pickle.dumps(KittiSweepReader())) == KittiSweepReader()
