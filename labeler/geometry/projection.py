"""The pinhole camera: points in the ego frame to pixels."""

import numpy as np
from numpy.typing import NDArray

from labeler.geometry.se3 import invert_se3, transform_points


def project_points(
    points_ego_m: NDArray[np.floating], ego_SE3_camera: NDArray[np.float64], intrinsics: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(N, 3) points in the ego frame to (N, 2) pixels and (N,) depths in metres along the optical axis.

    Pixels of points with a depth of 0 or less are NaN. Pixels may lie outside of the image."""
    points_camera_m = transform_points(invert_se3(ego_SE3_camera), points_ego_m)
    depth_m = points_camera_m[:, 2]
    homogeneous = points_camera_m @ intrinsics.T
    safe_depth_m = np.where(depth_m > 0, depth_m, np.nan)
    return homogeneous[:, :2] / safe_depth_m[:, None], depth_m
