"""Tracking with the camera's motion known, on drawn scenes: cars that stand while the camera turns or passes them."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labeler.detection.types import Detections
from labeler.tracking import NO_DETECTION, CameraMotion, DetectedFrame, Observations, TrackingConfig, open_tracker

FIFTH_NS = 200_000_000
INTRINSICS = np.array([[400.0, 0, 400], [0, 400, 200], [0, 0, 1]])
CONFIG = TrackingConfig()
Box = tuple[float, float, float, float]


def poses_of(yaw_rad: np.ndarray, forward_m: np.ndarray) -> np.ndarray:
    """(F, 4, 4) city_SE3_camera of a camera that looks along the city's x axis, turned to its right, moved ahead."""
    poses = np.zeros((len(yaw_rad), 4, 4))
    sine, cosine = np.sin(yaw_rad), np.cos(yaw_rad)
    poses[:, 0, 0], poses[:, 1, 0] = -sine, -cosine
    poses[:, 2, 1] = -1
    poses[:, 0, 2], poses[:, 1, 2] = cosine, -sine
    poses[:, 0, 3] = forward_m
    poses[:, 3, 3] = 1
    return poses


def seen(city_SE3_camera: np.ndarray, xyz_m: tuple[float, float, float]) -> Box:
    """The box of a square of 1.6 m that stands across the city's x axis."""
    corners = np.array([[xyz_m[0], xyz_m[1] + y, xyz_m[2] + z, 1] for y in (-0.8, 0.8) for z in (-0.8, 0.8)])
    x, y, depth = np.linalg.inv(city_SE3_camera)[:3] @ corners.T
    u, v = 400 + 400 * x / depth, 200 + 400 * y / depth
    return (float(u.min()), float(v.min()), float(u.max()), float(v.max()))


def frames_of(*boxes: list[Box]) -> list[DetectedFrame]:
    return [
        DetectedFrame(
            index,
            index * FIFTH_NS,
            Detections(
                np.array(found, np.float32).reshape(-1, 4),
                np.full(len(found), 0.9, np.float32),
                np.zeros(len(found), np.int16),
            ),
        )
        for index, found in enumerate(boxes)
    ]


def motion_of(poses: np.ndarray, height_m: float = 1.6) -> CameraMotion:
    return CameraMotion(np.arange(len(poses)) * FIFTH_NS, poses, INTRINSICS, np.array([height_m]))


def follow(frames: list[DetectedFrame], motion: CameraMotion | None, config: TrackingConfig) -> list[Observations]:
    return list(open_tracker(config, class_groups=(0,), motion=motion).track(frames, first_track_id=0))


def track_ids(observed: list[Observations]) -> set[int]:
    return {track for one in observed for track in one.track_id.tolist()}


# to the right, and back: at up to 1 rad/s, by up to .2 rad from image to image, which is 80 px at least
TURNING = poses_of(0.8 * np.sin(np.arange(20) * 0.25), np.zeros(20))
AHEAD = [(30.0, y, 0.0) for y in (-6.0, -2.0, 2.0, 6.0)]


@pytest.mark.parametrize("method", ["two_stage", "offline"])
def test_a_turn_swaps_no_cars(method: str) -> None:
    """Four parked cars of 21 px, 53 px from each other: from image to image a turn carries each beyond its neighbour.
    They stay themselves where the turn is known; where it is not, tracks go from car to car."""
    frames = frames_of(*([seen(pose, car) for car in AHEAD] for pose in TURNING))
    config = replace(CONFIG, method=method)
    known = follow(frames, motion_of(TURNING), config)
    assert [one.track_id.tolist() for one in known] == [[0, 1, 2, 3]] * 20
    unknown = follow(frames, None, config)
    assert [one.track_id.tolist() for one in unknown] != [[0, 1, 2, 3]] * 20


def test_gaps_are_filled_along_the_turn() -> None:
    """Nothing is detected in 4 images while the camera turns one way and back; the car is put where it is."""
    boxes = [seen(pose, AHEAD[1]) for pose in TURNING]
    frames = frames_of(*([] if 4 <= index < 8 else [box] for index, box in enumerate(boxes)))
    observed = follow(frames, motion_of(TURNING), CONFIG)
    assert [one.track_id.tolist() for one in observed] == [[0]] * 20
    for index in range(4, 8):
        assert observed[index].detection_index.tolist() == [NO_DETECTION]
        np.testing.assert_allclose(observed[index].xyxy_px, [boxes[index]], atol=1.5)


def test_fragments_are_stitched_over_a_turn() -> None:
    """Hidden for 2.4 s, twice as long as a track coasts, in which the camera turns."""
    frames = frames_of(*([] if 4 <= index < 15 else [seen(pose, AHEAD[1])] for index, pose in enumerate(TURNING)))
    assert track_ids(follow(frames, motion_of(TURNING), CONFIG)) == {0}
    assert track_ids(follow(frames, None, CONFIG)) != {0}


def test_following_back_goes_along_the_turn() -> None:
    """Too weak to begin a track at first; without the turn its box would be looked for where nothing is."""
    frames = frames_of(*([seen(pose, AHEAD[1])] for pose in TURNING))
    weak = [
        replace(one, detections=replace(one.detections, score=np.full(1, 0.2, np.float32))) if index < 5 else one
        for index, one in enumerate(frames)
    ]
    back = replace(CONFIG, follow_back=True)
    assert [one.track_id.tolist() for one in follow(weak, motion_of(TURNING), back)] == [[0]] * 20
    assert [one.track_id.tolist() for one in follow(weak, None, back)] != [[0]] * 20


@pytest.mark.parametrize(("height_m", "is_one"), [(1.6, True), (math.inf, False)])
def test_a_parked_car_that_is_passed_stays_one(height_m: float, *, is_one: bool) -> None:
    """4 m beside the way, at 20 m/s: from 24 m to 8 m away it moves and grows ever faster. It is hidden from 20 m to 12
    m. Its distance, which its height tells, says where it comes out; its speed before does not."""
    ahead = poses_of(np.zeros(5), np.arange(5) * 4.0)
    boxes = [seen(pose, (24.0, -4.0, 0.0)) for pose in ahead]
    frames = frames_of(boxes[:1], boxes[1:2], [], [], boxes[4:5])
    observed = follow(frames, motion_of(ahead, height_m), replace(CONFIG, method="two_stage"))
    assert (track_ids(observed) == {0}) is is_one


@pytest.mark.parametrize("method", ["two_stage", "offline"])
def test_a_camera_that_stands_still_changes_nothing(method: str) -> None:
    random = np.random.default_rng(0)
    corners = np.sort(random.uniform(0, 400, (30, 2, 2)), axis=1).reshape(30, 4)
    frames = frames_of(*([(x1, y1, x2, y2)] for x1, y1, x2, y2 in corners.tolist()))
    still = motion_of(poses_of(np.zeros(30), np.zeros(30)))
    config = replace(CONFIG, method=method)
    for known, unknown in zip(follow(frames, still, config), follow(frames, None, config), strict=True):
        assert known.track_id.tolist() == unknown.track_id.tolist()
        np.testing.assert_allclose(known.xyxy_px, unknown.xyxy_px, atol=1e-3)


def test_a_step_without_a_pose_is_predicted_as_without_any() -> None:
    """All poses but the first are unknown: nothing is different from a drive without poses."""
    unknown = TURNING.copy()
    unknown[1:] = np.nan
    frames = frames_of(*([seen(pose, car) for car in AHEAD] for pose in TURNING))
    for some, none in zip(follow(frames, motion_of(unknown), CONFIG), follow(frames, None, CONFIG), strict=True):
        assert some.track_id.tolist() == none.track_id.tolist()
        assert some.xyxy_px.tolist() == none.xyxy_px.tolist()


_POSE = st.sampled_from(["known", "unknown", "jump", "turned over"])


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(_POSE, st.integers(0, 2)), min_size=1, max_size=12), st.integers(0, 2**32 - 1))
def test_whatever_poses_are_boxes_are_finite(steps: list[tuple[str, int]], seed: int) -> None:
    """Poses that are missing, jump or turn the camera over, images at one time, cars at any place."""
    random = np.random.default_rng(seed)
    poses = poses_of(random.uniform(-0.2, 0.2, len(steps)), random.uniform(0, 3, len(steps)))
    for index, (kind, _) in enumerate(steps):
        if kind == "unknown":
            poses[index] = np.nan
        elif kind == "jump":
            poses[index, :3, 3] += 1e6
        elif kind == "turned over":
            poses[index, :3, 1:3] *= -1
    times_ns = np.cumsum([step for _, step in steps]) * FIFTH_NS
    frames: list[DetectedFrame] = []
    for index, time_ns in enumerate(times_ns.tolist()):
        corner = random.uniform(-100, 800, (6, 2))
        boxes = np.concatenate([corner, corner + random.uniform(0.5, 500, (6, 2))], axis=1).astype(np.float32)
        found = Detections(boxes, random.uniform(0.2, 1, 6).astype(np.float32), np.zeros(6, np.int16))
        frames.append(DetectedFrame(index, time_ns, found))
    kept = np.flatnonzero(np.diff(times_ns, append=-1) != 0)
    motion = CameraMotion(times_ns[kept], poses[kept], INTRINSICS, np.array([1.6]))
    for config in (CONFIG, replace(CONFIG, method="two_stage"), replace(CONFIG, follow_back=True)):
        for one in follow(frames, motion, config):
            assert np.isfinite(one.xyxy_px).all()
