"""Between CARLA's left-handed frames and ours, and from the bytes of its sensors to arrays.

CARLA's frames have x forward, y to the RIGHT and z up. Yaw turns x towards y (clockwise from above), pitch lifts the
nose, roll lowers the right side; they are applied in the order roll, pitch, yaw, in degrees
(https://carla.readthedocs.io/en/0.9.16/python_api/#carla.Rotation). Ours have y to the left. Mirroring y on both sides
of a motion keeps roll's sign and turns those of pitch and yaw. A sensor of CARLA, a camera too, looks along its x.
"""

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from labeler.geometry.se3 import se3

SENSOR_SE3_CAMERA = se3([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]], [0.0, 0.0, 0.0])
"""From a camera's x right, y down, z forward to x forward, y left, z up."""
_DEPTH_STEPS = 256**3 - 1
_DEPTH_RANGE_M = 1000.0


class CarlaVector(Protocol):
    """``carla.Location`` or ``carla.Vector3D``, in metres."""

    @property
    def x(self) -> float: ...
    @property
    def y(self) -> float: ...
    @property
    def z(self) -> float: ...


class CarlaRotation(Protocol):
    """``carla.Rotation``, in degrees."""

    @property
    def roll(self) -> float: ...
    @property
    def pitch(self) -> float: ...
    @property
    def yaw(self) -> float: ...


class CarlaTransform(Protocol):
    """``carla.Transform``: where a child is in its parent's frame."""

    @property
    def location(self) -> Any: ...
    @property
    def rotation(self) -> Any: ...


class CarlaImage(Protocol):
    """``carla.Image``: four bytes a pixel in the order blue, green, red, alpha."""

    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def raw_data(self) -> Any: ...


def parent_SE3_child(transform: CarlaTransform) -> NDArray[np.float64]:
    """(4, 4) the same motion between frames whose y is to the left."""
    return pose_of(transform.location, transform.rotation)


def pose_of(location: CarlaVector, rotation: CarlaRotation) -> NDArray[np.float64]:
    """(4, 4) ``parent_SE3_child`` of a child at ``location``, turned by ``rotation``."""
    angles_deg = [-rotation.yaw, -rotation.pitch, rotation.roll]
    turn = Rotation.from_euler("ZYX", angles_deg, degrees=True).as_matrix()
    return se3(turn, [location.x, -location.y, location.z])


def to_carla(parent_SE3_child: NDArray[np.float64]) -> tuple[dict[str, float], dict[str, float]]:
    """What makes the ``carla.Location`` (x, y, z) and the ``carla.Rotation`` (roll, pitch, yaw) of a motion of ours."""
    x, y, z = parent_SE3_child[:3, 3].tolist()
    yaw, pitch, roll = Rotation.from_matrix(parent_SE3_child[:3, :3]).as_euler("ZYX", degrees=True).tolist()
    return {"x": x, "y": -y, "z": z}, {"roll": roll, "pitch": -pitch, "yaw": -yaw}


def size_of(extent: CarlaVector) -> tuple[float, float, float]:
    """Length, width and height in metres from the half sides of a ``carla.BoundingBox``."""
    return 2 * extent.x, 2 * extent.y, 2 * extent.z


def pixels_of(image: CarlaImage) -> NDArray[np.uint8]:
    """(H, W, 4) uint8: blue, green, red, alpha."""
    return np.frombuffer(image.raw_data, dtype=np.uint8).reshape(image.height, image.width, 4)


def depth_of(image: CarlaImage) -> NDArray[np.float64]:
    """(H, W) metres along the camera's axis, from an image of ``sensor.camera.depth``.

    Red is the lowest byte, blue the highest (https://carla.readthedocs.io/en/0.9.16/ref_sensors/#depth-camera)."""
    steps = pixels_of(image)[..., :3].astype(np.float64) @ np.array([65536.0, 256.0, 1.0])
    return steps / _DEPTH_STEPS * _DEPTH_RANGE_M


def points_of(raw_data: Any) -> tuple[NDArray[np.float64], NDArray[np.float32]]:
    """(N, 3) points in metres in the sensor's frame, its y to the left, and (N,) intensities in 0..1, from the bytes of
    a ``carla.LidarMeasurement``."""
    rows = np.frombuffer(raw_data, dtype=np.float32).reshape(-1, 4)
    return rows[:, :3].astype(np.float64) * np.array([1.0, -1.0, 1.0]), rows[:, 3]
