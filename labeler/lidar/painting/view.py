"""A camera as the LiDAR step sees it: where points project to, and on which side of the image the others lie."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from labeler.drive.types import Camera
from labeler.geometry.se3 import invert_se3

MIN_DEPTH_M = 0.5
BORDER_SHARE = 0.01
"""A box that comes this close to the image's border, as a share of the image's side, is cut by it."""

LEFT, TOP, RIGHT, BOTTOM = range(4)


@dataclass(frozen=True, eq=False)
class Sight:
    """The points that project into an image: ``row`` (M,) intp in the given points, ``pixel`` (M, 2) float32,
    ``depth_m`` (M,) float32 along the optical axis."""

    row: NDArray[np.intp]
    pixel: NDArray[np.float32]
    depth_m: NDArray[np.float32]

    def __len__(self) -> int:
        return len(self.row)

    def __getitem__(self, rows: NDArray[np.bool_] | NDArray[np.intp]) -> Sight:
        return Sight(self.row[rows], self.pixel[rows], self.depth_m[rows])


@dataclass(frozen=True, eq=False)
class View:
    """``ego_SE3_camera`` (4, 4) from the camera at the image's time to the ego frame at the frame's time: a point is
    seen where the camera was when the image was taken. ``intrinsics`` (3, 3) in pixels, ``size_px`` width and height.
    """

    ego_SE3_camera: NDArray[np.float64]
    intrinsics: NDArray[np.float64]
    size_px: tuple[int, int]

    @staticmethod
    def of(camera: Camera, image_ego_SE3_frame_ego: NDArray[np.float64] | None = None) -> View:
        """The view of a camera; ``image_ego_SE3_frame_ego`` (4, 4) maps the ego frame at the frame's time to that at
        the image's time, identity when None. ValueError when the camera has no calibration."""
        if camera.calibration is None:
            raise ValueError(f"camera {camera.name} has no calibration: no point can be projected into it")
        ego_SE3_camera = camera.calibration.ego_SE3_camera
        if image_ego_SE3_frame_ego is not None:
            ego_SE3_camera = invert_se3(image_ego_SE3_frame_ego) @ ego_SE3_camera
        return View(ego_SE3_camera, camera.calibration.intrinsics, (camera.width_px, camera.height_px))

    @cached_property
    def camera_SE3_ego(self) -> NDArray[np.float64]:
        """(4, 4), the inverse of ``ego_SE3_camera``."""
        return invert_se3(self.ego_SE3_camera)

    @property
    def position_m(self) -> NDArray[np.float64]:
        """(3,) where the camera is in the ego frame."""
        return self.ego_SE3_camera[:3, 3]

    def see(self, xyz_m: NDArray[np.floating]) -> Sight:
        """Which of (N, 3) points in the ego frame project into the image. Those that are not finite do not."""
        matrix = (self.intrinsics @ self.camera_SE3_ego[:3]).astype(np.float32)
        with np.errstate(invalid="ignore", over="ignore"):  # points that are not finite get no finite pixel
            x, y, depth_m = matrix[:, :3] @ xyz_m.T.astype(np.float32, copy=False) + matrix[:, 3:]
            ahead = np.flatnonzero((depth_m > MIN_DEPTH_M) & (depth_m < np.inf))
            depth_m = depth_m[ahead]
            x, y = x[ahead] / depth_m, y[ahead] / depth_m
        width, height = self.size_px
        inside = np.flatnonzero((x >= 0) & (x < width) & (y >= 0) & (y < height))
        return Sight(ahead[inside], np.stack([x[inside], y[inside]], axis=1), depth_m[inside])

    def sides_cutting(self, xyxy_px: NDArray[np.floating]) -> NDArray[np.bool_]:
        """(N, 4) which sides of the image cut each of (N, 4) boxes: left, top, right, bottom."""
        near_px = BORDER_SHARE * np.array([*self.size_px, *self.size_px])
        low, high = np.zeros(2), np.array(self.size_px)
        return np.concatenate([xyxy_px[:, :2] <= low + near_px[:2], xyxy_px[:, 2:] >= high - near_px[2:]], axis=1)

    def beyond(self, xyz_m: NDArray[np.floating], sides: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """(N,) which of (N, 3) points lie beyond one of the image's ``sides`` (4,), in the order of
        :meth:`sides_cutting`: on the outer side of the plane through the camera and that side, also behind the camera.
        """
        matrix = self.camera_SE3_ego.astype(np.float32)
        x, y, depth_m = (xyz_m.astype(np.float32, copy=False) @ matrix[:3, :3].T + matrix[:3, 3]).T
        width, height = self.size_px
        (fx, _, cx), (_, fy, cy) = self.intrinsics[0], self.intrinsics[1]
        outside = np.stack(
            [
                fx * x + cx * depth_m < 0,
                fy * y + cy * depth_m < 0,
                fx * x + (cx - width) * depth_m > 0,
                fy * y + (cy - height) * depth_m > 0,
            ]
        )
        return np.asarray(outside[sides].any(axis=0))
