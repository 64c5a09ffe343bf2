"""Pose tables: order, repetition and bad rows."""

import numpy as np
import pytest

from labeler.drive.poses import poses_from_rows, se3_from_rows

_NAN = float("nan")


def test_rows_become_matrices() -> None:
    half = np.sqrt(0.5)
    wxyz = np.array([[1, 0, 0, 0], [half, 0, 0, half], [2.0, 0, 0, 2.0]])
    matrices = se3_from_rows(wxyz, np.array([[1.0, 2, 3]] * 3))
    np.testing.assert_allclose(matrices[0, :3], [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3]])
    np.testing.assert_allclose(matrices[1, :3], [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3]], atol=1e-12)
    np.testing.assert_allclose(matrices[2], matrices[1], atol=1e-12)


@pytest.mark.parametrize("row", [[0, 0, 0, 0, 1, 1, 1], [1, 0, 0, _NAN, 1, 1, 1], [1, 0, 0, 0, 1, _NAN, 1]])
def test_rows_that_are_no_pose_become_nan(row: list[float]) -> None:
    values = np.array([row, [1, 0, 0, 0, 5, 6, 7]], dtype=float)
    matrices = se3_from_rows(values[:, :4], values[:, 4:])
    assert np.isnan(matrices[0]).all()
    assert matrices[1, :3, 3].tolist() == [5, 6, 7]


@pytest.mark.parametrize(
    ("times_ns", "x_m", "expected", "warning"),
    [
        ([10, 20, 30], [1, 2, 3], [(10, 1), (20, 2), (30, 3)], None),  # as it should be
        ([30, 10, 20], [3, 1, 2], [(10, 1), (20, 2), (30, 3)], "out of order"),  # sorted
        ([10, 10, 20], [1, 9, 2], [(10, 1), (20, 2)], "left out 1 pose of a time"),  # the first is kept
        ([20, 10, 20], [2, 1, 9], [(10, 1), (20, 2)], "left out 1 pose of a time"),  # also when out of order
        ([10, 20, 30], [1, _NAN, 3], [(10, 1), (30, 3)], "left out 1 pose with a number that is not finite"),
    ],
)
def test_tables(times_ns: list[int], x_m: list[float], expected: list[tuple[int, float]], warning: str | None) -> None:
    matrices = se3_from_rows(np.tile([1.0, 0, 0, 0], (3, 1)), np.stack([x_m, [0, 0, 0], [0, 0, 0]], axis=1))
    warnings: list[str] = []
    poses = poses_from_rows(np.array(times_ns), matrices, source="the table", warnings=warnings)
    assert poses is not None
    assert list(zip(poses.timestamp_ns.tolist(), poses.city_SE3_ego[:, 0, 3].tolist(), strict=True)) == expected
    assert (warning or "") in " ".join(warnings)
    assert bool(warnings) == (warning is not None)


def test_a_table_without_a_good_row_gives_no_poses() -> None:
    warnings: list[str] = []
    assert poses_from_rows(np.array([1]), np.full((1, 4, 4), _NAN), source="the table", warnings=warnings) is None
    assert "holds no pose that can be used" in warnings[-1]
