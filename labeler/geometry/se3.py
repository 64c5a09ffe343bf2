"""Rigid motions in 3D as 4x4 matrices: ``a_SE3_b`` maps b's coordinates to a's."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation


def se3(rotation: ArrayLike, translation_m: ArrayLike) -> NDArray[np.float64]:
    """(4, 4) matrix from a (3, 3) rotation and a (3,) translation in metres."""
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    matrix[:3, 3] = translation_m
    return matrix


def se3_from_quaternion(qw: float, qx: float, qy: float, qz: float, translation_m: ArrayLike) -> NDArray[np.float64]:
    """(4, 4) matrix from a quaternion, scalar first, of any positive length. ValueError when it has length zero or is
    not finite.
    """
    if not (np.isfinite([qw, qx, qy, qz]).all() and np.isfinite(translation_m).all()):
        raise ValueError("the quaternion or the translation is not finite")
    return se3(Rotation.from_quat([qx, qy, qz, qw]).as_matrix(), translation_m)


def invert_se3(a_SE3_b: NDArray[np.float64]) -> NDArray[np.float64]:
    """``b_SE3_a``, (4, 4)."""
    rotation = a_SE3_b[:3, :3].T
    return se3(rotation, -rotation @ a_SE3_b[:3, 3])


def transform_points(a_SE3_b: NDArray[np.float64], points_b: NDArray[np.floating]) -> NDArray[np.float64]:
    """(N, 3) points in b's frame to a's."""
    return points_b @ a_SE3_b[:3, :3].T + a_SE3_b[:3, 3]


def yaw_of(a_SE3_b: NDArray[np.float64]) -> float:
    """The angle in radians about z by which b's x axis is turned in a's x-y plane."""
    return float(np.arctan2(a_SE3_b[1, 0], a_SE3_b[0, 0]))


def interpolate_se3(
    times_ns: NDArray[np.int64], poses: NDArray[np.float64], wanted_ns: NDArray[np.int64]
) -> NDArray[np.float64]:
    """(M, 4, 4) the poses at ``wanted_ns`` (M,) among (N, 4, 4) ``poses`` at increasing ``times_ns`` (N,): linear in
    place, slerp in rotation.

    Outside of the times, the nearest pose. N must be at least 1."""
    right = np.clip(np.searchsorted(times_ns, wanted_ns), 1, max(len(times_ns) - 1, 1))
    before, after = right - 1, np.minimum(right, len(times_ns) - 1)
    length_ns = times_ns[after] - times_ns[before]
    share = np.clip((wanted_ns - times_ns[before]) / np.maximum(length_ns, 1), 0.0, 1.0)
    found = poses[before].copy()
    between = np.flatnonzero(share > 0)  # what is asked for at a recorded time is answered as it was recorded
    if len(between):
        start = Rotation.from_matrix(poses[before[between], :3, :3])
        turn = start.inv() * Rotation.from_matrix(poses[after[between], :3, :3])
        part = share[between, None]
        found[between, :3, :3] = (start * Rotation.from_rotvec(part * turn.as_rotvec())).as_matrix()
        found[between, :3, 3] = (1 - part) * poses[before[between], :3, 3] + part * poses[after[between], :3, 3]
    found[share == 1.0] = poses[after[share == 1.0]]
    return found
