"""Traffic around a car with four cameras, by arithmetic: what each camera sees of which object in which frame.

Every object passes the car on a straight line, so it wanders from camera to camera as in a real drive. A pinhole camera
looks ahead, to the left, to the right and to the rear; their views overlap a little at the seams.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

CAMERAS = ("front", "left", "right", "rear")
YAW_DEG = (0.0, 90.0, -90.0, 180.0)
WIDTH_PX, HEIGHT_PX = 640, 400
FOCAL_PX = 250.0  # 104 degrees wide: neighbours overlap by 14
CAMERA_HEIGHT_M = 1.5
PERIOD_S = 0.1
CLASS_NAMES = ("car", "truck", "bus", "person", "bicycle")
SIZES_M = np.array([[4.5, 1.8, 1.5], [8.0, 2.5, 3.2], [11.0, 2.6, 3.2], [0.6, 0.6, 1.75], [1.8, 0.6, 1.7]])
SHARES = (0.62, 0.1, 0.04, 0.16, 0.08)
LONGEST_VIEW_M, NEAREST_M = 70.0, 2.5
GAP_EVERY, GAP_FRAMES = 4, 8
_CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0.0, 1.0)])


@dataclass(frozen=True, eq=False)
class Objects:
    """What drives and walks around, a row each: ``class_id`` (N,), ``size_m`` (N, 3) as length, width, height,
    ``first_frame`` and ``frames`` (N,) when it is there, ``start_m`` and ``speed_mps`` (N, 2) in the car's frame."""

    class_id: NDArray[np.int16]
    size_m: NDArray[np.float64]
    first_frame: NDArray[np.int64]
    frames: NDArray[np.int64]
    start_m: NDArray[np.float64]
    speed_mps: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Sightings:
    """Boxes of objects in images, a row each, in order of camera, object and frame.

    ``xyxy_px`` (N, 4); ``center_m`` (N, 3) of the 3D box and ``yaw_rad`` (N,), both in the car's frame; ``distance_m``
    (N,) to the camera.
    """

    camera: NDArray[np.int64]
    obj: NDArray[np.int64]
    frame: NDArray[np.int64]
    xyxy_px: NDArray[np.float64]
    center_m: NDArray[np.float64]
    yaw_rad: NDArray[np.float64]
    distance_m: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.frame)

    def __getitem__(self, rows: NDArray[np.bool_] | NDArray[np.intp]) -> Sightings:
        return Sightings(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))


def make_objects(count: int, drive_frames: int, random: np.random.Generator) -> Objects:
    """Objects whose lives are spread over the drive."""
    class_id = random.choice(len(CLASS_NAMES), count, p=SHARES).astype(np.int16)
    frames = random.integers(90, 200, count)
    first_frame = random.integers(0, drive_frames, count) - frames // 2
    reach_m = random.uniform(20, LONGEST_VIEW_M, count)
    ahead = random.choice((-1.0, 1.0), count)
    side_m = random.choice((-1.0, 1.0), count) * random.uniform(3.5, 28, count)
    # It comes from one end and leaves at the other within its life.
    speed = -2 * ahead * reach_m / (frames * PERIOD_S)
    return Objects(
        class_id=class_id,
        size_m=SIZES_M[class_id] * random.uniform(0.9, 1.1, (count, 1)),
        first_frame=first_frame,
        frames=frames,
        start_m=np.stack([ahead * reach_m, side_m], axis=1),
        speed_mps=np.stack([speed, random.normal(0, 0.15, count)], axis=1),
    )


def see(objects: Objects, drive_frames: int, *, at_most: int) -> Sightings:
    """What the cameras see of the objects; ``at_most`` so many boxes, the far ends of tracks being left out first."""
    obj = np.repeat(np.arange(len(objects.frames)), objects.frames)
    age = np.arange(len(obj)) - np.repeat(np.cumsum(objects.frames) - objects.frames, objects.frames)
    frame = objects.first_frame[obj] + age
    there = (frame >= 0) & (frame < drive_frames)
    obj, age, frame = obj[there], age[there], frame[there]
    xy_m = objects.start_m[obj] + objects.speed_mps[obj] * (age * PERIOD_S)[:, None]
    yaw_rad = np.arctan2(objects.speed_mps[obj, 1], objects.speed_mps[obj, 0])
    seen = [_in_camera(number, objects, obj, frame, xy_m, yaw_rad) for number in range(len(CAMERAS))]
    names = Sightings.__dataclass_fields__
    found = Sightings(*(np.concatenate([getattr(part, name) for part in seen]) for name in names))
    found = found[np.lexsort((found.frame, found.obj, found.camera))]
    found = found[~_in_gap(found)]
    if len(found) > at_most:
        kept = np.zeros(len(found), np.bool_)
        kept[np.argsort(found.distance_m, kind="stable")[:at_most]] = True
        found = found[kept]
    return found


def _in_gap(found: Sightings) -> NDArray[np.bool_]:
    """(N,) bool: in one run of four, nothing is seen for some frames, as if something stood in front."""
    run = np.cumsum(np.diff(found.camera * 1_000_000 + found.obj, prepend=-1) != 0) - 1
    first = np.searchsorted(run, run)
    length = np.bincount(run)[run]
    within = np.arange(len(found)) - first
    middle = length // 2
    return (
        (found.obj % GAP_EVERY == 0) & (length > 5 * GAP_FRAMES) & (within >= middle) & (within < middle + GAP_FRAMES)
    )


def _in_camera(
    camera: int,
    objects: Objects,
    obj: NDArray[np.int64],
    frame: NDArray[np.int64],
    xy_m: NDArray[np.float64],
    yaw_rad: NDArray[np.float64],
) -> Sightings:
    size_m = objects.size_m[obj]
    corners = _CORNERS[None] * size_m[:, None, :]
    cos, sin = np.cos(yaw_rad)[:, None], np.sin(yaw_rad)[:, None]
    x = xy_m[:, :1] + corners[..., 0] * cos - corners[..., 1] * sin
    y = xy_m[:, 1:] + corners[..., 0] * sin + corners[..., 1] * cos
    turn = np.radians(YAW_DEG[camera])
    depth = x * np.cos(turn) + y * np.sin(turn)
    right = x * np.sin(turn) - y * np.cos(turn)
    down = CAMERA_HEIGHT_M - corners[..., 2]
    distance_m = np.hypot(xy_m[:, 0], xy_m[:, 1])
    depth_of_center = xy_m[:, 0] * np.cos(turn) + xy_m[:, 1] * np.sin(turn)
    safe = np.maximum(depth, 0.3)
    u, v = WIDTH_PX / 2 + FOCAL_PX * right / safe, HEIGHT_PX * 0.48 + FOCAL_PX * down / safe
    box = np.stack([u.min(axis=1), v.min(axis=1), u.max(axis=1), v.max(axis=1)], axis=1)
    whole = (box[:, 2] - box[:, 0]) * (box[:, 3] - box[:, 1])
    box[:, 0::2] = box[:, 0::2].clip(0, WIDTH_PX)
    box[:, 1::2] = box[:, 1::2].clip(0, HEIGHT_PX)
    inside = (box[:, 2] - box[:, 0]) * (box[:, 3] - box[:, 1])
    big_enough = (box[:, 2] - box[:, 0] >= 4) & (box[:, 3] - box[:, 1] >= 4)
    seen = (depth_of_center > NEAREST_M) & (inside > 0.25 * whole) & big_enough
    center_m = np.column_stack([xy_m, size_m[:, 2] / 2])
    return Sightings(
        camera=np.full(seen.sum(), camera),
        obj=obj[seen],
        frame=frame[seen],
        xyxy_px=box[seen],
        center_m=center_m[seen],
        yaw_rad=yaw_rad[seen],
        distance_m=distance_m[seen],
    )
