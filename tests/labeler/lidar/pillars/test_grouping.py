"""Points grouped into pillars, counted by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labeler.lidar.pillars.grouping import POINTS_PER_PILLAR, Grid, features_of, pillars_of

GRID = Grid(x_min_m=0.0, y_min_m=-2.0, cell_m=1.0, rows=3, columns=4)


def cloud(*points: tuple[float, ...]) -> np.ndarray:
    return np.array(points, np.float32).reshape(-1, 4)


def test_points_lie_in_the_pillar_of_their_cell_with_features_from_its_middle_and_mean() -> None:
    pillars = pillars_of(cloud((1.25, 0.5, 1.0, 0.3), (1.75, 0.5, 2.0, 0.5)), GRID)
    assert pillars.cell.tolist() == [1 * 4 + 2]
    assert pillars.points.shape == (1, POINTS_PER_PILLAR, features_of(4))
    # z, intensity; from the middle of the cell (1.5, 0.5); in the grid, in units of 50 m; from the mean (1.5, 0.5, 1.5)
    np.testing.assert_allclose(pillars.points[0, 0], [1, 0.3, -0.25, 0, 0.025, 0.01, -0.25, 0, -0.5], atol=1e-6)
    np.testing.assert_allclose(pillars.points[0, -1], [2, 0.5, 0.25, 0, 0.035, 0.01, 0.25, 0, 0.5], atol=1e-6)


def test_of_many_points_those_evenly_spread_over_the_height_stay() -> None:
    heights = np.random.default_rng(0).permutation(71) / 10
    pillars = pillars_of(cloud(*((0.5, 0.5, z, 0.0) for z in heights)), GRID)
    np.testing.assert_allclose(pillars.points[0, :, 0], np.arange(8), atol=1e-6)


@pytest.mark.parametrize(
    "point",
    [
        (-0.01, 0, 0, 0),  # before the grid
        (3.0, 0, 0, 0),  # at its far edge
        (1, 2.0, 0, 0),  # beside it
        (np.nan, 0, 0, 0),
    ],
)
def test_what_lies_outside_of_the_grid_is_left_out(point: tuple[float, ...]) -> None:
    pillars = pillars_of(cloud(point), GRID)
    assert pillars.points.shape == (0, POINTS_PER_PILLAR, features_of(4))
    assert pillars.cell.dtype == np.int64


@given(st.lists(st.tuples(*(st.integers(-48, 80).map(lambda sixteenths: sixteenths / 16) for _ in range(4)))))
def test_every_cell_with_points_is_a_pillar_filled_with_points_of_its_own(points: list[tuple[float, ...]]) -> None:
    given_cloud = cloud(*points)
    inside = [row for row in given_cloud.tolist() if 0 <= row[0] < 3 and -2 <= row[1] < 2]

    pillars = pillars_of(given_cloud, GRID)

    assert sorted(pillars.cell.tolist()) == sorted({int(x) * 4 + int(y + 2) for x, y, *_ in inside})
    told = np.rint(pillars.points[..., [4, 5]] * 50 * 16) / 16  # x and y, told in units of 50 m
    cell = told[..., 0].astype(int) * 4 + (told[..., 1] + 2).astype(int)
    assert (cell == pillars.cell[:, None]).all()


def test_a_grid_without_cells_is_refused() -> None:
    with pytest.raises(ValueError, match="cells of some size"):
        Grid(0, 0, 0.0, 1, 1)
