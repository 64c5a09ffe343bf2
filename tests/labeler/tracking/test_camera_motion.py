"""What a camera's motion does to boxes, by hand: f = 100 px, the principal point at (200, 100)."""

import math

import numpy as np
import pytest

from labeler.drive import Calibration, Camera, Poses
from labeler.tracking import CameraMotion

TENTH_NS = 100_000_000
INTRINSICS = np.array([[100.0, 0, 200], [0, 100, 100], [0, 0, 1]])
TALL_M = np.array([2.0])
FAR = np.array([np.inf])


def pose(*, yaw_deg: float = 0.0, forward_m: float = 0.0, right_m: float = 0.0) -> np.ndarray:
    """city_SE3_camera of a camera that looks along the city's x axis: turned to its right, and moved."""
    yaw = math.radians(yaw_deg)
    matrix = np.eye(4)
    matrix[:3, 0] = [-math.sin(yaw), -math.cos(yaw), 0]  # right
    matrix[:3, 1] = [0, 0, -1]  # down
    matrix[:3, 2] = [math.cos(yaw), -math.sin(yaw), 0]  # forward
    matrix[:3, 3] = [forward_m, -right_m, 1.5]
    return matrix


def moving(*poses: np.ndarray, height_m: np.ndarray = TALL_M, step_ns: int = TENTH_NS) -> CameraMotion:
    return CameraMotion(np.arange(len(poses)) * step_ns, np.stack(poses), INTRINSICS, height_m)


@pytest.mark.parametrize(
    ("after", "height_m", "before_box", "after_box"),
    [
        # as before
        (pose(), TALL_M, [200, 100, 20, 10], [200, 100, 20, 10]),
        # by 10 degrees to the right: the sides, seen at 5.71 degrees left and right before, are at 15.71 and 4.29 to
        # the left now, 28.13 and 7.50 px; the middles of the upper and lower side lie 1 / cos 10 farther out
        (pose(yaw_deg=10), FAR, [200, 100, 20, 10], [182.19, 100, 20.63, 10.15]),
        # 10 px tall at 2 m are 20 m away; 10 m on everything is twice as far from the principal point and as large
        (pose(forward_m=10), TALL_M, [230, 104, 20, 10], [260, 108, 40, 20]),
        # the same of what is infinitely far
        (pose(forward_m=10), FAR, [230, 104, 20, 10], [230, 104, 20, 10]),
        # 2 m to the right at 20 m: 10 px to the left
        (pose(right_m=2), TALL_M, [230, 104, 20, 10], [220, 104, 20, 10]),
        # 19 m on, 1 m before it: it passes, and where is not said
        (pose(forward_m=19), TALL_M, [230, 104, 20, 10], [230, 104, 20, 10]),
    ],
)
def test_boxes_move_as_if_they_stood_still(
    after: np.ndarray, height_m: np.ndarray, before_box: list[float], after_box: list[float]
) -> None:
    motion = moving(pose(), after, height_m=height_m, step_ns=1_000_000_000)
    box = np.array([before_box], np.float64).T
    expected = np.array([after_box], np.float64).T - box
    found = motion.step(0, 1_000_000_000).displacements(box, height_m)
    np.testing.assert_allclose(found, expected, atol=0.01)
    # each box by a step of its own is the same as all by one, and a second step is not mixed up with the first
    both = motion.steps(np.array([0, 1]), np.array([1, 1])).displacements(np.tile(box, 2), np.repeat(height_m, 2))
    np.testing.assert_allclose(both, np.concatenate([found, np.zeros((4, 1))], axis=1), atol=1e-9)


def test_back_in_time_is_the_way_back() -> None:
    motion = moving(pose(), pose(forward_m=10), step_ns=1_000_000_000)
    back = motion.step(1_000_000_000, 0).displacements(np.array([[260.0], [108], [40], [20]]), TALL_M)
    np.testing.assert_allclose(back, [[-30], [-4], [-20], [-10]])


@pytest.mark.parametrize(
    ("second", "step_ns"),
    [
        (np.full((4, 4), np.nan), TENTH_NS),  # nobody knows where it was
        (pose(forward_m=11), TENTH_NS),  # 110 m/s
        (pose(yaw_deg=40), TENTH_NS),  # 7 rad/s
        (pose(forward_m=0.1), 0),  # somewhere else at the same time
    ],
)
def test_what_is_not_known_or_not_believed_moves_nothing(second: np.ndarray, step_ns: int) -> None:
    motion = moving(pose(), second, step_ns=step_ns)
    step = motion.steps(np.array([0]), np.array([1]))
    assert step.displacements(np.array([[230.0], [104], [20], [10]]), TALL_M).tolist() == [[0], [0], [0], [0]]


def test_a_time_without_an_image_moves_nothing() -> None:
    motion = moving(pose(), pose(forward_m=1), pose(forward_m=2))
    box = np.array([[230.0], [104], [20], [10]])
    assert not motion.step(0, TENTH_NS + 1).displacements(box, TALL_M).any()
    assert motion.step(0, 2 * TENTH_NS).displacements(box, TALL_M).any()  # an image between may be missing


def test_rows_at_other_times() -> None:
    """Frames of a window: two known ones the other way round, and one that the camera has no image of."""
    motion = moving(pose(), pose(forward_m=1), pose(forward_m=2))
    some = motion.at(np.array([2 * TENTH_NS, 5, 0]))
    assert some.city_SE3_camera[[0, 2], 0, 3].tolist() == [2.0, 0.0]
    assert np.isnan(some.city_SE3_camera[1]).all()
    assert motion.rows(np.array([TENTH_NS, 7])).tolist() == [1, -1]


CAMERA = Camera("front", 400, 200, Calibration(INTRINSICS, pose()))


def drive_poses(*times_ns: int) -> Poses:
    """1 m on in 100 ms."""
    poses = np.tile(np.eye(4), (len(times_ns), 1, 1))
    poses[:, 0, 3] = np.array(times_ns) / TENTH_NS
    return Poses(np.array(times_ns, np.int64), poses)


def test_poses_are_taken_at_the_time_of_the_image() -> None:
    """Images lie 30 ms after the poses; the last one has no pose near, the one before is just past the end."""
    motion = CameraMotion.of(
        CAMERA, drive_poses(0, TENTH_NS, 2 * TENTH_NS), [130_000_000, 30_000_000, 230_000_000, 900_000_000], TALL_M
    )
    assert motion is not None
    assert motion.timestamp_ns.tolist() == [30_000_000, 130_000_000, 230_000_000, 900_000_000]
    np.testing.assert_allclose(motion.city_SE3_camera[:3, 0, 3], [0.3, 1.3, 2.0])
    np.testing.assert_allclose(motion.city_SE3_camera[0, :3, :3], pose()[:3, :3])
    assert np.isnan(motion.city_SE3_camera[3]).all()


def test_poses_that_are_none_are_left_out() -> None:
    poses = drive_poses(0, TENTH_NS, 2 * TENTH_NS, 3 * TENTH_NS)
    poses.city_SE3_ego[1] = np.nan
    poses.city_SE3_ego[3] = 0.0
    motion = CameraMotion.of(CAMERA, poses, [TENTH_NS], TALL_M)
    assert motion is not None
    np.testing.assert_allclose(motion.city_SE3_camera[0, 0, 3], 1.0)  # between its neighbours


@pytest.mark.parametrize(
    ("camera", "poses"),
    [
        (Camera("front", 400, 200, None), drive_poses(0)),
        (CAMERA, None),
        (CAMERA, drive_poses()),
        (CAMERA, Poses(np.array([0], np.int64), np.full((1, 4, 4), np.nan))),
        (Camera("front", 400, 200, Calibration(np.zeros((3, 3)), pose())), drive_poses(0)),
        (Camera("front", 400, 200, Calibration(np.full((3, 3), np.nan), pose())), drive_poses(0)),
    ],
)
def test_without_calibration_or_poses_there_is_none(camera: Camera, poses: Poses | None) -> None:
    assert CameraMotion.of(camera, poses, [0], TALL_M) is None
