"""A car 4.4 m long and 1.8 m wide that drives along x of the city, 10 m/s, seen by an ego car that stands."""

import numpy as np
import pytest

from labeler.lidar import Boxes3D, BoxSource, refine_track_boxes

SIZE_M = (4.4, 1.8, 1.5)


def car(
    x_m: list[float],
    *,
    yaw_deg: float | list[float] = 0.0,
    size_m: tuple[float, float, float] = SIZE_M,
    y_m: float = 5.0,
) -> Boxes3D:
    """Boxes with centres at ``x_m``, all of whose sides were seen."""
    count = len(x_m)
    half = np.array(size_m[:2]) / 2
    return Boxes3D(
        center_m=np.array([[x, 5.0, 0.75] for x in x_m], np.float32),
        size_m=np.tile(np.array(size_m, np.float32), (count, 1)),
        yaw_rad=np.radians(np.broadcast_to(yaw_deg, count)).astype(np.float32),
        score=np.full(count, 0.8, np.float32),
        class_id=np.zeros(count, np.int16),
        num_points=np.full(count, 30, np.int32),
        detection_index=np.arange(count, dtype=np.int32),
        source=np.full(count, BoxSource.CLUSTER, np.int8),
        center_std_m=np.full((count, 2), 0.2, np.float32),
        yaw_std_rad=np.full(count, 0.1, np.float32),
        seen_m=np.tile(np.array([*-half, *half], np.float32), (count, 1)),
        offset_s=np.zeros(count, np.float32),
    )


def refine(boxes: Boxes3D, **more: np.ndarray) -> Boxes3D:
    count = len(boxes)
    poses = np.tile(np.eye(4), (count, 1, 1))
    return refine_track_boxes(boxes, poses, np.arange(count, dtype=np.int64) * 100_000_000, **more)


def test_a_car_that_has_moved_points_along_its_path():
    # It drives towards -x; its boxes point the other way, and one was fitted a quarter turn wrong.
    refined = refine(car([30, 29, 28, 27, 26, 25], yaw_deg=[0, 2, 0, 90, -2, 0]))
    np.testing.assert_allclose(np.abs(np.degrees(refined.yaw_rad)), 180, atol=2.5)
    assert set(refined.source.tolist()) == {BoxSource.TRACK}


def test_a_car_that_stands_takes_the_axis_that_most_of_its_boxes_agree_on():
    refined = refine(car([20.0, 20.1, 19.9, 20.0], yaw_deg=[29, 31, 210, 85]))
    np.testing.assert_allclose(np.degrees(refined.yaw_rad) % 180, 30, atol=0.5)
    assert (refined.yaw_std_rad < 0.1).all()


def test_all_boxes_of_a_track_have_one_size_and_the_near_side_stays():
    boxes = car([20, 20, 20, 20])
    small = Boxes3D.concatenate([boxes[:3], car([20.5], size_m=(3.4, 1.8, 1.5))])
    refined = refine(small)
    np.testing.assert_allclose(refined.size_m, np.tile(SIZE_M, (4, 1)), atol=1e-5)
    # The near end of the short one lies at 20.5 - 1.7 = 18.8 m: a car of 4.4 m from there has its middle at 21 m.
    np.testing.assert_allclose(refined.center_m[3, :2], [21.0, 5.0], atol=1e-5)


def test_a_known_velocity_is_taken_and_the_ego_cars_own_turn_is_taken_out():
    boxes = car([20, 20])
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[:, :2, :2] = [[0, -1], [1, 0]]  # the ego car looks along y of the city
    poses[1, 1, 3] = 3.0
    velocity_mps = np.array([[0.0, 10.0], [0.0, 10.0]])
    refined = refine_track_boxes(boxes, poses, np.array([0, 300_000_000]), velocity_mps=velocity_mps)
    np.testing.assert_allclose(refined.yaw_rad, 0, atol=1e-3)


def test_no_boxes_and_rows_that_do_not_match():
    assert len(refine(Boxes3D.empty())) == 0
    with pytest.raises(ValueError, match="2 boxes need poses"):
        refine_track_boxes(car([1, 2]), np.zeros((1, 4, 4)), np.zeros(2, np.int64))
