"""One camera that looks along x from 1 m above the ego frame's origin: 400 x 200 px, focal length 200 px."""

from dataclasses import replace

import numpy as np
import pytest

from labeler.drive.types import Calibration, Camera, TruthBoxes3D
from labeler.evaluation.made_observations import Scene, SeenObjects, seen_objects
from labeler.evaluation.made_observations.rigs import RIGS, every_nth_frame, with_rig
from labeler.geometry.se3 import se3

AXES = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
CAMERA = Camera(
    "front", 400, 200, Calibration(np.array([[200.0, 0, 200], [0, 200, 100], [0, 0, 1]]), se3(AXES, [0, 0, 1.0]))
)


def scene(*cubes: tuple[float, float], num_points: list[int] | None = None) -> Scene:
    """Cubes of 2 m on the ground with their middles at (x, y), one object each, in one frame."""
    count = len(cubes)
    boxes = TruthBoxes3D(
        np.zeros(count, np.int32),
        tuple(f"cube {number}" for number in range(count)),
        ("REGULAR_VEHICLE",) * count,
        np.array([[x, y, 1.0] for x, y in cubes]).reshape(-1, 3),
        np.full((count, 3), 2.0),
        np.zeros(count),
        None if num_points is None else np.array(num_points),
    )
    return Scene(
        "cubes", (CAMERA,), np.zeros(1, np.int64), np.eye(4)[None], (frozenset({"front"}),), boxes,
        np.arange(count, dtype=np.int32), np.zeros(count, np.int16), None,
    )  # fmt: skip


def seen(*cubes: tuple[float, float], num_points: list[int] | None = None) -> SeenObjects:
    (frame,) = seen_objects(scene(*cubes, num_points=num_points))
    return frame["front"]


@pytest.mark.parametrize(
    ("cube", "box", "cut"),
    [
        # The near face, 10 m ahead, is 2 m wide: 200 / 10 * 2 = 40 px, around the middle.
        ((11, 0), (180, 80, 220, 120), (0, 0)),
        # 9 m to the left: the near left corner at 200 - 200 * 10 / 10 = 0, the far right one at 200 - 200 * 8 / 12.
        ((11, 9), (0, 80, 200 - 200 * 8 / 12, 120), (0, 0)),
        # 10 m to the left, uncut from -20 to 50: 20 of 70 px are beyond the edge.
        ((11, 10), (0, 80, 50, 120), (20 / 70, 0)),
    ],
)
def test_a_cube_is_projected_and_cut_at_the_edge(
    cube: tuple[float, float], box: tuple[float, ...], cut: tuple[float, float]
):
    found = seen(cube)
    np.testing.assert_allclose(found.xyxy_px, [box], atol=1e-9)
    np.testing.assert_allclose(found.cut, [cut], atol=1e-9)
    assert found.distance_m[0] == pytest.approx(np.hypot(*cube))


@pytest.mark.parametrize("cube", [(-11.0, 0.0), (11.0, 30.0), (0.0, 5.0)])
def test_what_is_behind_or_beside_the_image_is_not_seen(cube: tuple[float, float]):
    assert len(seen(cube)) == 0


def test_a_cube_half_behind_the_camera_shows_the_half_before_it():
    # From x = -0.5 to 1.5, on the left: it fills the image from its left edge to where its far end ends.
    found = seen((0.5, 2.0))
    np.testing.assert_allclose(found.xyxy_px[0, [0, 2]], [0, 200 - 200 * 1 / 1.5], atol=1e-6)
    assert found.cut[0, 0] >= 0.5


def test_a_nearer_cube_hides_a_farther_one():
    near, far = seen((6, 0), (11, 0)).visible_share
    assert near == 1
    assert far == 0
    # Beside it by a metre, about half of the far one's 40 px show: the near one ends at 240, the far one spans 200-240
    # shifted to the right by 20 px for each metre at 10 m.
    assert seen((6, 0), (11, -3)).visible_share[1] == pytest.approx(0.8, abs=0.2)


def test_without_a_lidar_point_an_object_is_hidden():
    assert seen((11, 0), (11, 6), num_points=[0, 5]).visible_share.tolist() == [0, 1]


def test_another_rig_sees_the_same_truth():
    changed = with_rig(scene((11, 0)), "seven-and-stereo")
    assert len(changed.cameras) == len(RIGS["seven-and-stereo"]) == 9
    (frame,) = seen_objects(changed)
    assert {name for name, objects in frame.items() if len(objects)} == {
        "ring_front_center", "stereo_front_left", "stereo_front_right",
    }  # fmt: skip


def test_at_half_the_rate_every_other_frame_is_left():
    one = scene((11, 0))
    three = replace(
        one,
        timestamp_ns=np.array([0, 100, 200]),
        city_SE3_ego=np.tile(np.eye(4), (3, 1, 1)),
        cameras_at=one.cameras_at * 3,
        boxes=replace(
            one.boxes,
            frame_index=np.array([0, 1, 2], np.int32),
            track_uuid=("a", "a", "a"),
            category=("CAR",) * 3,
            center_m=np.array([[11.0, 0, 1], [12, 0, 1], [13, 0, 1]]),
            size_m=np.full((3, 3), 2.0),
            yaw_rad=np.zeros(3),
        ),
        object_id=np.zeros(3, np.int32),
        category_class=np.zeros(3, np.int16),
    )
    half = every_nth_frame(three, 2)
    assert half.timestamp_ns.tolist() == [0, 200]
    assert half.boxes.frame_index.tolist() == [0, 1]
    assert half.boxes.center_m[:, 0].tolist() == [11, 13]
