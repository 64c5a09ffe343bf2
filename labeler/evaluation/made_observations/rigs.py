"""Other rigs for a scene: the same truth, seen by other cameras.

Only calibrations are made up, so a drive with 3D truth tells how merging does on cars that nobody here owns.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from labeler.drive.types import Calibration, Camera
from labeler.evaluation.made_observations.scene import Scene
from labeler.geometry.se3 import se3

_CAMERA_AXES = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
_ROOF_M = 1.6

# Name: yaw in degrees, field of view in degrees, width and height in pixels, and how far left of the middle in metres.
_Layout = Mapping[str, tuple[float, float, int, int, float]]
RIGS: Mapping[str, _Layout] = MappingProxyType(
    {
        "seven-and-stereo": {
            "ring_front_center": (0, 49, 1550, 2048, 0.0),
            "ring_front_left": (45, 63, 2048, 1550, 0.2),
            "ring_front_right": (-45, 63, 2048, 1550, -0.2),
            "ring_side_left": (99, 63, 2048, 1550, 0.3),
            "ring_side_right": (-99, 63, 2048, 1550, -0.3),
            "ring_rear_left": (153, 63, 2048, 1550, 0.2),
            "ring_rear_right": (-153, 63, 2048, 1550, -0.2),
            "stereo_front_left": (0, 63, 2048, 1550, 0.25),
            "stereo_front_right": (0, 63, 2048, 1550, -0.25),
        },
        "six-around": {
            "front": (0, 65, 1600, 900, 0.0),
            "front_left": (55, 65, 1600, 900, 0.4),
            "front_right": (-55, 65, 1600, 900, -0.4),
            "back": (180, 90, 1600, 900, 0.0),
            "back_left": (110, 65, 1600, 900, 0.4),
            "back_right": (-110, 65, 1600, 900, -0.4),
        },
        "three-wide": {
            "front": (0, 80, 1936, 1216, 0.0),
            "left": (70, 90, 1936, 1216, 0.3),
            "right": (-70, 90, 1936, 1216, -0.3),
        },
        "four-with-gaps": {
            "front": (0, 70, 1280, 720, 0.0),
            "left": (90, 70, 1280, 720, 0.5),
            "right": (-90, 70, 1280, 720, -0.5),
            "rear": (180, 70, 1280, 720, 0.0),
        },
    }
)
"""Rigs by name: the field of view is horizontal."""


def with_rig(scene: Scene, rig: str) -> Scene:
    """The scene as cameras of another rig see it; recorded 2D boxes don't fit them, so objects are projected."""
    cameras = tuple(_camera(name, *layout) for name, layout in RIGS[rig].items())
    looking = frozenset(camera.name for camera in cameras)
    return replace(scene, cameras=cameras, cameras_at=(looking,) * len(scene.timestamp_ns), recorded=None)


def every_nth_frame(scene: Scene, step: int) -> Scene:
    """The scene at a lower rate."""
    kept = np.arange(0, len(scene.timestamp_ns), step)
    at = np.full(len(scene.timestamp_ns), -1)
    at[kept] = np.arange(len(kept))
    rows = np.flatnonzero(at[scene.boxes.frame_index] >= 0)
    boxes = scene.boxes
    return replace(
        scene,
        timestamp_ns=scene.timestamp_ns[kept],
        city_SE3_ego=scene.city_SE3_ego[kept],
        cameras_at=tuple(scene.cameras_at[frame] for frame in kept.tolist()),
        boxes=replace(
            boxes,
            frame_index=at[boxes.frame_index[rows]].astype(np.int32),
            track_uuid=tuple(boxes.track_uuid[int(row)] for row in rows),
            category=tuple(boxes.category[int(row)] for row in rows),
            center_m=boxes.center_m[rows],
            size_m=boxes.size_m[rows],
            yaw_rad=boxes.yaw_rad[rows],
            num_points=None if boxes.num_points is None else boxes.num_points[rows],
        ),
        object_id=scene.object_id[rows],
        category_class=scene.category_class[rows],
        recorded=None
        if scene.recorded is None
        else {(camera, int(at[frame])): seen for (camera, frame), seen in scene.recorded.items() if at[frame] >= 0},
    )


def _camera(name: str, yaw_deg: float, field_deg: float, width_px: int, height_px: int, left_m: float) -> Camera:
    cos, sin = np.cos(np.radians(yaw_deg)), np.sin(np.radians(yaw_deg))
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    place_m = np.array([1.3 + 0.3 * cos, left_m, _ROOF_M])
    focal_px = width_px / 2 / np.tan(np.radians(field_deg) / 2)
    intrinsics = np.array([[focal_px, 0.0, width_px / 2], [0.0, focal_px, height_px / 2], [0.0, 0.0, 1.0]])
    return Camera(name, width_px, height_px, Calibration(intrinsics, se3(turn @ _CAMERA_AXES, place_m)))
