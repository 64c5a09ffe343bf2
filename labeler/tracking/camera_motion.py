"""What the car's own motion does to boxes in the images of one of its cameras.

From one image to the next the camera turns and drives on. Where its poses are known, so is what that does to a box,
and only the rest has to be learned from the boxes. The turn moves what lies in a direction, however far away it is. The
way driven moves and scales it as well, by its distance, as if it stood still: how far away it is follows from how tall
it looks and how tall its class usually is. With ``K`` the intrinsics, ``R`` and ``t`` the camera's turn and way, and
``q`` one over the depth, a pixel ``p`` goes to ``K (R K^-1 p + q t)``. Source: Hartley and Zisserman, Multiple View
Geometry in Computer Vision, 2004, chapters 8 and 9.

To a Kalman filter this is a known control input: it is added to the position that is predicted, and variances don't
change. The speeds of the filter's state are then those of what the car's own motion does not explain.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from hashlib import blake2b

import numpy as np
from numpy.typing import NDArray

from labeler.drive.types import Camera, Poses

_Array = NDArray[np.float64]
_Rows = NDArray[np.intp]

_NS_PER_S = 1_000_000_000
_NEAR_POSE_NS = _NS_PER_S // 2
"""An image has a pose where one was recorded so near in time."""

_FASTEST_M_S = 100.0
_FASTEST_TURN_RAD_S = 6.0
"""No car moves faster: where poses say so, they jump."""

_LEAST_DEPTH_RATIO, _MOST_DEPTH_RATIO = 0.2, 5.0
"""What comes nearer or goes away by more in one step passes the camera, and no picture of it says where it will be."""


@dataclass(frozen=True, eq=False)
class CameraMotion:
    """Where one camera was when each of its images was taken.

    ``timestamp_ns`` (F,) int64, strictly increasing; ``city_SE3_camera`` (F, 4, 4) float64 in metres, NaN where nobody
    knows; ``intrinsics`` (3, 3) in pixels; ``usual_height_m`` (C,) of each class, infinite where only the camera's turn
    is to be reckoned with.
    """

    timestamp_ns: NDArray[np.int64]
    city_SE3_camera: _Array
    intrinsics: _Array
    usual_height_m: _Array

    @staticmethod
    def of(
        camera: Camera, poses: Poses | None, timestamp_ns: Sequence[int], usual_height_m: _Array
    ) -> CameraMotion | None:
        """The motion of a camera over the times of its images, in any order; None without calibration or poses, or
        where a camera matrix can't be inverted."""
        if camera.calibration is None or poses is None:
            return None
        poses = _sound(poses)
        intrinsics = camera.calibration.intrinsics
        is_camera = np.isfinite(intrinsics).all() and np.linalg.det(intrinsics) > 0
        if len(poses.timestamp_ns) == 0 or not is_camera:
            return None
        times_ns = np.unique(np.array(timestamp_ns, np.int64))
        city_SE3_camera = np.full((len(times_ns), 4, 4), np.nan)
        near = _are_near_pose(poses, times_ns)
        city_SE3_camera[near] = poses.at_each(times_ns[near]) @ camera.calibration.ego_SE3_camera
        return CameraMotion(times_ns, city_SE3_camera, intrinsics, usual_height_m)

    def content(self) -> tuple[str, list[float], list[float]]:
        """All that predictions depend on, as plain values: for keys."""
        poses = blake2b(self.timestamp_ns.tobytes() + self.city_SE3_camera.tobytes(), digest_size=16).hexdigest()
        return poses, self.intrinsics.ravel().tolist(), self.usual_height_m.tolist()

    def at(self, timestamp_ns: NDArray[np.int64]) -> CameraMotion:
        """The same at the times (N,) of some images: rows are these, in their order."""
        row = self.rows(timestamp_ns)
        city_SE3_camera = np.full((len(row), 4, 4), np.nan)
        city_SE3_camera[row >= 0] = self.city_SE3_camera[row[row >= 0]]
        return CameraMotion(timestamp_ns, city_SE3_camera, self.intrinsics, self.usual_height_m)

    def rows(self, timestamp_ns: NDArray[np.int64]) -> _Rows:
        """(N,) the row of each time (N,), -1 where no image was taken then."""
        if len(self.timestamp_ns) == 0:
            return np.full(len(timestamp_ns), -1, np.intp)
        row = np.minimum(np.searchsorted(self.timestamp_ns, timestamp_ns), len(self.timestamp_ns) - 1)
        return np.where(self.timestamp_ns[row] == timestamp_ns, row, -1)

    def steps(self, before: _Rows, after: _Rows) -> Steps:
        """The camera's motion from rows ``before`` (N,) to rows ``after`` (N,), which may be earlier ones. None, as if
        it stood still, where a row is -1, a pose is not known, or poses jump."""
        a, b = self.city_SE3_camera[before], self.city_SE3_camera[after]
        turn = b[:, :3, :3].transpose(0, 2, 1) @ a[:, :3, :3]
        way_m = np.einsum("nji,nj->ni", b[:, :3, :3], a[:, :3, 3] - b[:, :3, 3])
        dt_s = np.abs(self.timestamp_ns[after] - self.timestamp_ns[before]) / _NS_PER_S
        with np.errstate(invalid="ignore"):
            angle_rad = np.arccos(np.clip((np.trace(turn, axis1=1, axis2=2) - 1) / 2, -1.0, 1.0))
            known = (np.linalg.norm(way_m, axis=1) <= _FASTEST_M_S * dt_s) & (angle_rad <= _FASTEST_TURN_RAD_S * dt_s)
        known &= (before >= 0) & (after >= 0)
        homography = self.intrinsics @ turn @ np.linalg.inv(self.intrinsics)
        shift = way_m @ self.intrinsics.T
        homography[~known], shift[~known] = np.eye(3), 0.0
        return Steps(homography, shift, float(self.intrinsics[1, 1]))

    @cached_property
    def _from_row_to_next(self) -> Steps:
        rows = np.arange(len(self.timestamp_ns))
        return self.steps(rows[:-1], rows[1:])

    def step(self, before_ns: int, after_ns: int) -> Steps:
        """The one step between two times."""
        before, after = self.rows(np.array([before_ns, after_ns])).tolist()
        if before >= 0 and after == before + 1:  # the usual one is known already
            return self._from_row_to_next[before : before + 1]
        return self.steps(np.array([before]), np.array([after]))


@dataclass(frozen=True, eq=False)
class Steps:
    """N motions of a camera: ``homography`` (N, 3, 3) of its turn, ``shift`` (N, 3) in pixels times metres of its way,
    and the focal length that heights are seen with."""

    homography: _Array
    shift: _Array
    focal_px: float

    def __getitem__(self, rows: slice | NDArray[np.integer]) -> Steps:
        return Steps(self.homography[rows], self.shift[rows], self.focal_px)

    def displacements(self, position: _Array, height_m: _Array) -> _Array:
        """(4, B) how far boxes (4, B) of things ``height_m`` (B,) tall that stand still move in the image, each by its
        own step or all by the only one: in centre x, centre y, width and height. 0 for those that pass the camera."""
        x, y, width, height = position
        half_width, half_height = width / 2, height / 2
        points = np.ones((3, 4, len(x)))  # the middles of the left, right, upper and lower side
        points[0] = x
        points[1] = y
        points[0, 0] -= half_width
        points[0, 1] += half_width
        points[1, 2] -= half_height
        points[1, 3] += half_height
        inverse_depth = np.maximum(height, 0.0) / (self.focal_px * height_m)
        if len(self.homography) == 1:
            seen = (self.homography[0] @ points.reshape(3, -1)).reshape(points.shape)
            seen += self.shift[0][:, None, None] * inverse_depth
        else:
            seen = np.einsum("nij,jkn->ikn", self.homography, points)
            seen += self.shift.T[:, None] * inverse_depth
        ratio = seen[2]
        sound = ((ratio > _LEAST_DEPTH_RATIO) & (ratio < _MOST_DEPTH_RATIO)).all(axis=0)
        seen = seen[:2] / np.where(sound, ratio, 1.0)
        left, right, top, bottom = seen[0, 0], seen[0, 1], seen[1, 2], seen[1, 3]
        carried = np.stack([(left + right) / 2, (top + bottom) / 2, right - left, bottom - top])
        return np.where(sound, carried - position, 0.0)


@dataclass(frozen=True, eq=False)
class TracksMotion:
    """What a ``camera`` does to the tracks of a window: its rows are the window's frames, ``height_m`` (T,) is how tall
    the object of each track is."""

    camera: CameraMotion
    height_m: _Array

    def between(self, position: _Array, track: NDArray[np.int64], before: _Rows, after: _Rows) -> _Array:
        """(4, B) how far boxes (4, B) of tracks (B,) move from frames ``before`` (B,) to frames ``after`` (B,)."""
        return self.camera.steps(before, after).displacements(position, self.height_m[track])

    def into_frame(self, position: _Array, track: NDArray[np.int64], frame: NDArray[np.int64]) -> _Array:
        """(4, B) the same from the frame before ``frame`` (B,)."""
        return self._into_each[frame].displacements(position, self.height_m[track])

    @cached_property
    def _into_each(self) -> Steps:
        frame = np.arange(len(self.camera.timestamp_ns))
        return self.camera.steps(np.maximum(frame - 1, 0), frame)


def _sound(poses: Poses) -> Poses:
    """Those that are finite and turn."""
    with np.errstate(invalid="ignore"):
        sound = np.isfinite(poses.city_SE3_ego).all(axis=(1, 2)) & (np.linalg.det(poses.city_SE3_ego[:, :3, :3]) > 0)
    return Poses(poses.timestamp_ns[sound], poses.city_SE3_ego[sound])


def _are_near_pose(poses: Poses, times_ns: NDArray[np.int64]) -> NDArray[np.bool_]:
    """(F,) whether a pose was recorded near each time (F,)."""
    right = np.searchsorted(poses.timestamp_ns, times_ns)
    beside_ns = poses.timestamp_ns[np.clip(np.stack([right - 1, right]), 0, len(poses.timestamp_ns) - 1)]
    return np.abs(beside_ns - times_ns).min(axis=0) <= _NEAR_POSE_NS
