"""The sensors of the simulated ego car: four cameras and a LiDAR on its roof.

The ego frame is Argoverse 2's but for its height: x forward, y left, z up, the origin below the middle of the rear
axle, here on the ground. Neighbouring cameras overlap by ten degrees.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.geometry.se3 import se3

CAMERA_YAW_DEG = {"front": 0.0, "left": 90.0, "right": -90.0, "rear": 180.0}
FIELD_OF_VIEW_DEG = 100.0
_CAMERA_ABOVE_ROOF_M = 0.3
_CAMERA_OFF_CENTER_M = 0.45
_LIDAR_ABOVE_ROOF_M = 0.6
_CAMERA_AXES = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""A camera that looks ahead: its right, down and forward as columns in the ego frame."""


@dataclass(frozen=True, eq=False)
class View:
    """One camera: ``intrinsics`` (3, 3) in pixels, counted from the image's upper left corner, and ``ego_SE3_camera``
    (4, 4), the camera's x to the right, y down and z forward."""

    camera: str
    width_px: int
    height_px: int
    intrinsics: NDArray[np.float64]
    ego_SE3_camera: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Rig:
    """Where the sensors are. ``body_SE3_ego`` maps the ego frame to the frame of the car's model, whose origin is the
    middle of the body on the ground. ``lidar_m`` is in the ego frame."""

    views: tuple[View, ...]
    lidar_m: tuple[float, float, float]
    body_SE3_ego: NDArray[np.float64]

    @classmethod
    def on_roof(cls, *, rear_axle_m: float, height_m: float, width_px: int, height_px: int) -> "Rig":
        """The rig of a car with images of that size. ``rear_axle_m`` is the x of its rear axle in its model's frame."""
        ahead_m = -rear_axle_m
        focal_px = width_px / 2 / np.tan(np.radians(FIELD_OF_VIEW_DEG) / 2)
        intrinsics = np.array([[focal_px, 0.0, width_px / 2], [0.0, focal_px, height_px / 2], [0.0, 0.0, 1.0]])
        views: list[View] = []
        for name, yaw_deg in CAMERA_YAW_DEG.items():
            cos, sin = np.cos(np.radians(yaw_deg)), np.sin(np.radians(yaw_deg))
            turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
            place_m = np.array([ahead_m, 0.0, height_m + _CAMERA_ABOVE_ROOF_M])
            place_m[:2] += turn[:2, 0] * _CAMERA_OFF_CENTER_M
            views.append(View(name, width_px, height_px, intrinsics, se3(turn @ _CAMERA_AXES, place_m)))
        return cls(
            views=tuple(views),
            lidar_m=(ahead_m, 0.0, height_m + _LIDAR_ABOVE_ROOF_M),
            body_SE3_ego=se3(np.eye(3), np.array([-ahead_m, 0.0, 0.0])),
        )
