"""What the sensors of the fake CARLA see: boxes on a level ground, found by casting rays in left-handed frames.

Written apart from the recorder's own geometry on purpose: x forward, y to the right, z up, and rotation matrices
spelled out as CARLA reckons them, so that a wrong sign in the recorder shows.
"""

import math

import numpy as np
from numpy.typing import NDArray

GROUND = 0
FAR_M = 1000.0


def left_handed_matrix(
    x: float, y: float, z: float, roll_deg: float, pitch_deg: float, yaw_deg: float
) -> NDArray[np.float64]:
    """(4, 4) as ``carla.Transform.get_matrix`` gives it."""
    cr, sr = math.cos(math.radians(roll_deg)), math.sin(math.radians(roll_deg))
    cp, sp = math.cos(math.radians(pitch_deg)), math.sin(math.radians(pitch_deg))
    cy, sy = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
    return np.array([
        [cp * cy, cy * sp * sr - sy * cr, -cy * sp * cr - sy * sr, x],
        [cp * sy, sy * sp * sr + cy * cr, -sy * sp * cr + cy * sr, y],
        [sp, -cp * sr, cp * cr, z],
        [0.0, 0.0, 0.0, 1.0],
    ])  # fmt: skip


def camera_rays(width: int, height: int, fov_deg: float) -> NDArray[np.float64]:
    """(H * W, 3) directions through the middles of pixels in a sensor's frame, each 1 m long along its x."""
    focal = width / 2 / math.tan(math.radians(fov_deg) / 2)
    columns, rows = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    right, up = (columns - width / 2) / focal, -(rows - height / 2) / focal
    rays = np.stack([np.ones(columns.size), right.ravel(), up.ravel()], axis=1)
    return np.asarray(rays, dtype=np.float64)


def lidar_rays(channels: int, columns: int, upper_deg: float, lower_deg: float) -> NDArray[np.float64]:
    """(channels * columns, 3) unit directions in a sensor's frame, channel by channel from the highest."""
    elevation = np.radians(np.linspace(upper_deg, lower_deg, channels))[:, None]
    azimuth = np.linspace(0, 2 * np.pi, columns, endpoint=False)[None]
    level = np.cos(elevation)
    rays = np.stack([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation) + 0 * azimuth], axis=-1)
    return np.asarray(rays, dtype=np.float64).reshape(-1, 3)


def cast(
    world_sensor: NDArray[np.float64],
    rays: NDArray[np.float64],
    boxes: list[tuple[int, NDArray[np.float64], NDArray[np.float64]]],
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """How many times its length (N,) each ray reaches until it meets something, and what (N,): a box's number, or
    GROUND. ``boxes`` are numbers, (4, 4) ``world_box`` and (3,) half sides. The sky is FAR_M away."""
    directions = rays @ world_sensor[:3, :3].T
    origin = world_sensor[:3, 3]
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = np.where(directions[:, 2] < 0, -origin[2] / directions[:, 2], FAR_M)
    reach = np.minimum(reach, FAR_M)
    what = np.full(len(rays), GROUND)
    for number, world_box, half in boxes:
        turn = world_box[:3, :3].T
        start, along = (turn @ (origin - world_box[:3, 3]))[:, None], turn @ directions.T
        with np.errstate(divide="ignore", invalid="ignore"):
            first, second = (-half[:, None] - start) / along, (half[:, None] - start) / along
        enter = np.minimum(first, second).max(axis=0)
        leave = np.maximum(first, second).min(axis=0)
        met = (enter <= leave) & (enter > 0) & (enter < reach)
        reach[met], what[met] = enter[met], number
    return reach, what
