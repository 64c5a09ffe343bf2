"""Frames from readings: hand-made clocks in milliseconds, and properties that hold for any."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from labeler.drive.synchronisation import reference_order, synchronise
from labeler.drive.types import Frame, ImageFile, SweepFile

_FILE = Path("file")
_MS = 1_000_000


def _images(camera: str, times_ms: Sequence[float]) -> list[ImageFile]:
    return [ImageFile(camera, round(time * _MS), _FILE) for time in times_ms]


def _synchronise(lidar_ms: Sequence[float], **cameras_ms: Sequence[float]) -> tuple[tuple[Frame, ...], tuple[str, ...]]:
    images = {camera: _images(camera, times_ms) for camera, times_ms in cameras_ms.items()}
    return synchronise(images, [SweepFile(round(time * _MS), _FILE) for time in lidar_ms])


def _table(frames: Sequence[Frame]) -> list[tuple[int, bool, dict[str, int]]]:
    """(time, has a sweep, image times by camera) of each frame in milliseconds."""
    return [
        (frame.timestamp_ns // _MS, frame.sweep is not None,
         {camera: image.timestamp_ns // _MS for camera, image in frame.images.items()})
        for frame in frames
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("lidar_ms", "front_ms", "expected"),
    [
        # each image goes to the nearest sweep, before or behind it
        ([0, 100, 200], [10, 95, 230], [(0, True, 10), (100, True, 95), (200, True, 230)]),
        # a camera of twice the rate: the nearest of two wins, the other is in no frame
        ([0, 100, 200], [0, 50, 100, 150, 200], [(0, True, 0), (100, True, 100), (200, True, 200)]),
        # half a period away still counts, and goes to the earlier of two equally near sweeps
        ([0, 100, 200], [50, 150, 250], [(0, True, 50), (100, True, 150), (200, True, 250)]),
        # one missing sweep: the camera fills in
        ([0, 100, 300, 400], [0, 100, 200, 300, 400],
         [(0, True, 0), (100, True, 100), (200, False, 200), (300, True, 300), (400, True, 400)]),
        # a fast camera fills a longer gap at the LiDAR's period, not at its own
        ([0, 100, 200, 600, 700], [*range(0, 701, 50)],
         [(0, True, 0), (100, True, 100), (200, True, 200), (300, False, 300), (400, False, 400), (500, False, 500),
          (600, True, 600), (700, True, 700)]),
        # images before the first sweep and after the last
        ([300, 400], [100, 200, 300, 400, 500, 600],
         [(100, False, 100), (200, False, 200), (300, True, 300), (400, True, 400), (500, False, 500),
          (600, False, 600)]),
        # one sweep only: its period is taken to be 100 ms
        ([1000], [957, 1100], [(1000, True, 957), (1100, False, 1100)]),
        # no LiDAR: the camera is the clock
        ([], [0, 33, 66], [(0, False, 0), (33, False, 33), (66, False, 66)]),
    ],
)  # fmt: skip
def test_one_camera(lidar_ms: list[int], front_ms: list[int], expected: list[tuple[int, bool, int]]) -> None:
    frames, warnings = _synchronise(lidar_ms, front=front_ms)
    assert _table(frames) == [(time, swept, {"front": image}) for time, swept, image in expected]
    assert [frame.index for frame in frames] == list(range(len(frames)))
    assert warnings == ()


def test_jitter_does_not_lose_images_that_fire_half_a_period_after_the_lidar() -> None:
    frames, _ = _synchronise([0, 100, 204, 300, 396, 500], front=[50, 152, 252, 348, 448])
    assert sum("front" in frame.images for frame in frames) == 5


def test_cameras_of_different_rates_share_the_lidar_clock() -> None:
    frames, _ = _synchronise([0, 100, 200], front=[5, 105, 205], stereo=[7, 207])
    assert _table(frames) == [
        (0, True, {"front": 5, "stereo": 7}),
        (100, True, {"front": 105}),
        (200, True, {"front": 205, "stereo": 207}),
    ]


def test_a_sweep_that_no_image_is_near_to_is_counted_and_left_out() -> None:
    frames, warnings = _synchronise([0, 100, 200, 300], front=[100, 300])
    assert _table(frames) == [(100, True, {"front": 100}), (300, True, {"front": 300})]
    assert warnings == ("Left out 2 LiDAR sweeps that no image is near to (2 of 4).",)


def test_where_the_reference_camera_is_missing_another_camera_fills_the_gap() -> None:
    frames, _ = _synchronise([], front=[0, 100, 200, 300, 400], rear=[500, 600, 700])
    assert _table(frames)[4:] == [
        (400, False, {"front": 400}),
        (500, False, {"rear": 500}),
        (600, False, {"rear": 600}),
        (700, False, {"rear": 700}),
    ]


def test_a_lidar_clock_that_is_off_by_years_costs_neither_memory_nor_images() -> None:
    frames, warnings = _synchronise([0, 100], front=[1e12, 1e12 + 100])
    assert [len(frame.images) for frame in frames] == [1, 1]
    assert warnings == ("Left out 2 LiDAR sweeps that no image is near to (2 of 2).",)


def test_nothing_recorded_gives_no_frames() -> None:
    assert synchronise({}, []) == ((), ())


@pytest.mark.parametrize(
    ("counts", "expected"),
    [
        ({"b": 3, "a": 2}, ["b", "a"]),  # most images
        ({"b": 3, "a": 3}, ["a", "b"]),  # then by name
        ({"a_left": 3, "CAM_FRONT": 3}, ["CAM_FRONT", "a_left"]),  # but one that says front first
        ({"CAM_FRONT": 2, "CAM_BACK": 3}, ["CAM_BACK", "CAM_FRONT"]),  # more images beat the name
    ],
)
def test_reference_order(counts: dict[str, int], expected: list[str]) -> None:
    assert reference_order(counts) == expected


_times_ms = st.lists(st.integers(0, 3000), max_size=25, unique=True).map(sorted)


@given(_times_ms, _times_ms, _times_ms)
def test_every_image_and_sweep_is_in_one_frame_at_most(lidar: list[int], front: list[int], rear: list[int]) -> None:
    frames, _ = _synchronise(lidar, front=front, rear=rear)
    for camera in ("front", "rear"):
        used = [frame.images[camera].timestamp_ns for frame in frames if camera in frame.images]
        assert used == sorted(set(used))
    sweeps = [frame.sweep.timestamp_ns for frame in frames if frame.sweep]
    assert len(sweeps) == len(set(sweeps))
    assert all(frame.sweep.timestamp_ns == frame.timestamp_ns for frame in frames if frame.sweep)


@given(_times_ms, _times_ms, _times_ms)
def test_frames_have_images_and_run_in_order(lidar: list[int], front: list[int], rear: list[int]) -> None:
    frames, _ = _synchronise(lidar, front=front, rear=rear)
    assert all(frame.images for frame in frames)
    assert [frame.index for frame in frames] == list(range(len(frames)))
    times = [frame.timestamp_ns for frame in frames]
    assert times == sorted(set(times))
    assert bool(frames) == bool(front or rear)


@given(st.integers(2, 60), st.integers(2, 60), st.sets(st.integers(0, 60)))
def test_no_image_of_a_camera_in_step_is_lost_wherever_sweeps_are_missing(
    first: int, count: int, missing: set[int]
) -> None:
    lidar = [100 * index for index in range(first, first + count) if index not in missing]
    assume(len(lidar) > 1 and np.median(np.diff(lidar)) == 100)
    images = [100 * index + 20 for index in range(130)]
    frames, _ = _synchronise(lidar, front=images)
    assert [frame.images["front"].timestamp_ns // _MS for frame in frames] == images
