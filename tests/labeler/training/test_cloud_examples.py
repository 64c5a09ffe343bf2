"""Windows of clouds: what is changed in the points is changed in the truth, and what is asked for can be found."""

from dataclasses import replace

import numpy as np
import pytest

from labeler.lidar.pillars.grouping import DIRECTION_GRID, Grid
from labeler.training.cloud_examples import CloudExample, CloudSampler, Move, with_fewer_points, with_spoilt_paint
from labeler.training.clouds import MIN_POINTS, points_inside
from labeler.training.errors import TrainingError
from labeler.training.pillar_targets import targets_of
from tests.labeler.training.made_clouds import CAR_M, direction

SWEEP = direction((15, 3, 20), (30, -6, -90))
WHOLE = CloudExample(SWEEP.cloud(), DIRECTION_GRID, SWEEP.truth, SWEEP.classes, SWEEP.asked, SWEEP.reach_rad)


@pytest.mark.parametrize(
    ("move", "expected"),
    [
        (Move(1, 0, 1, 0), (15, 3, 0.75, *CAR_M, 20)),
        (Move(-1, 0, 1, 0), (15, -3, 0.75, *CAR_M, -20)),  # mirrored
        (Move(1, np.radians(90), 1, 0), (-3, 15, 0.75, *CAR_M, 110)),  # turned to the left
        (Move(1, 0, 2, 0), (30, 6, 1.5, *(2 * side for side in CAR_M), 20)),  # twice as large
        (Move(1, 0, 1, 0.5), (15, 3, 0.75, *CAR_M, 20)),  # points are higher, as over badly known ground
    ],
)
def test_a_move_is_the_same_for_boxes_and_points(move: Move, expected: tuple[float, ...]) -> None:
    box = move.of_boxes(SWEEP.truth)[0]
    np.testing.assert_allclose(box, [*expected[:6], np.radians(expected[6])], atol=1e-5)
    before = points_inside(SWEEP.cloud()[:, :3], SWEEP.truth[0], 0.05)
    after = points_inside(move.of_cloud(SWEEP.cloud())[:, :3], box, 0.55)
    assert before.sum() == 120
    assert (after >= before).all()


def test_the_image_reaches_as_far_after_a_move() -> None:
    reach_rad = np.radians([-50, 40]).astype(np.float32)
    np.testing.assert_allclose(Move(-1, 0, 1, 0).of_reach(reach_rad), np.radians([-40, 50]), atol=1e-6)
    np.testing.assert_allclose(Move(1, 0.1, 1, 0).of_reach(reach_rad), np.radians([-50, 40]) + 0.1, atol=1e-6)


def test_windows_hold_a_vehicle_that_can_be_found() -> None:
    sampler, found = CloudSampler([SWEEP], rows=40, columns=40, around_objects=1.0), 0
    for seed in range(30):
        example = sampler.draw(np.random.default_rng(seed))
        grid = example.grid
        assert (grid.rows, grid.columns) == (40, 40)
        assert (example.cloud[:, 0] >= grid.x_min_m - 1e-3).all()
        assert (example.cloud[:, 1] < grid.y_max_m + 1e-3).all()
        found += targets_of(example).objects >= 1
        for row in np.flatnonzero(example.asked):
            if max(abs(example.truth[row, :2] - [grid.x_min_m + 8, grid.y_min_m + 8])) < 4:
                assert points_inside(example.cloud[:, :3], example.truth[row], 0.3).sum() >= MIN_POINTS
    assert found >= 25  # a far one may have lost the few beams that met it


def test_the_same_seed_draws_the_same_example() -> None:
    sampler = CloudSampler([SWEEP], rows=40, columns=40)
    one, other = sampler.draw(np.random.default_rng(5)), sampler.draw(np.random.default_rng(5))
    np.testing.assert_array_equal(one.cloud, other.cloud)


def test_a_vehicle_that_loses_its_points_is_not_asked_for() -> None:
    bare = replace(WHOLE, cloud=WHOLE.cloud[:30])  # the clutter alone
    seeds = [seed for seed in range(60) if not with_fewer_points(bare, np.random.default_rng(seed)).asked.any()]
    assert len(seeds) == 60
    assert WHOLE.asked.all()


def test_spoilt_paint_changes_paint_alone_and_stays_between_0_and_1() -> None:
    changed = 0
    for seed in range(40):
        cloud = with_spoilt_paint(WHOLE, np.random.default_rng(seed)).cloud
        np.testing.assert_array_equal(cloud[:, :4], WHOLE.cloud[:, :4])
        assert cloud[:, 4:].min() >= 0
        assert cloud[:, 4:].max() <= 1
        changed += not np.array_equal(cloud, WHOLE.cloud)
    assert 10 < changed < 40


def test_empty_windows_are_examples_too() -> None:
    empty = replace(WHOLE, cloud=WHOLE.cloud[:0])
    for seed in range(20):
        rng = np.random.default_rng(seed)
        assert len(with_spoilt_paint(with_fewer_points(empty, rng), rng).cloud) == 0


def test_without_vehicles_there_is_nothing_to_learn() -> None:
    with pytest.raises(TrainingError, match="No vehicle"):
        CloudSampler([direction()], rows=40, columns=40)


def test_targets_lie_where_the_vehicles_are() -> None:
    grid = Grid(x_min_m=10, y_min_m=-2, cell_m=0.5, rows=20, columns=20)  # cells of the answer are 1 m wide
    targets = targets_of(replace(WHOLE, grid=grid))
    assert targets.objects == 1
    assert np.unravel_index(int(targets.heat.argmax()), targets.heat.shape) in [(4, 4), (5, 5), (4, 5), (5, 4)]
    assert targets.heat.max() == 1
    x_m = grid.x_min_m + 0.5 + targets.cell // 10
    y_m = grid.y_min_m + 0.5 + targets.cell % 10
    np.testing.assert_allclose(x_m + targets.box[:, 0], 15, atol=1e-5)
    np.testing.assert_allclose(y_m + targets.box[:, 1], 3, atol=1e-5)


@pytest.mark.parametrize(
    ("asked", "reach_deg", "at_vehicle", "elsewhere"),
    [
        (True, (-50, 50), True, True),
        (False, (-50, 50), False, True),  # neither right nor wrong there
        (True, (-50, 0), True, False),  # the image ends before it, yet shows some of it
    ],
)
def test_where_an_answer_counts(asked: bool, reach_deg: tuple[float, float], at_vehicle: bool, elsewhere: bool) -> None:
    grid = Grid(x_min_m=10, y_min_m=-2, cell_m=0.5, rows=20, columns=40)
    reach_rad = np.radians(reach_deg).astype(np.float32)
    targets = targets_of(replace(WHOLE, grid=grid, asked=np.array([asked, True]), reach_rad=reach_rad))
    assert bool(targets.counts[4, 4]) is at_vehicle  # 14.5 m ahead, 2.5 m to the left
    assert bool(targets.counts[0, 13]) is elsewhere  # 10.5 m ahead, 11.5 m to the left
