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
        matrix = np.empty((len(known), 3, 4))
        matrix[:, :, :3] = self.intrinsics @ turn @ np.linalg.inv(self.intrinsics)
        matrix[:, :, 3] = way_m @ self.intrinsics.T
        matrix[~known] = np.eye(3, 4)
        return Steps(np.ascontiguousarray(matrix.transpose(1, 2, 0)), float(self.intrinsics[1, 1]))

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
    """N motions of a camera: ``matrix`` (3, 4, N) is the homography of its turn, and in the last column its way, in
    pixels times metres; ``focal_px`` is the focal length that heights are seen with."""

    matrix: _Array
    focal_px: float

    def __getitem__(self, rows: slice | NDArray[np.integer]) -> Steps:
        return Steps(self.matrix[:, :, rows], self.focal_px)

    def displacements(self, position: _Array, height_m: _Array) -> _Array:
        """(4, B) how far boxes (4, B) of things ``height_m`` (B,) tall that stand still move in the image, each by its
        own step or all by the only one: in centre x, centre y, width and height. 0 for those that pass the camera."""
        x, y, width, height = position
        inverse_depth = np.maximum(height, 0.0) / (self.focal_px * height_m)
        of_x, of_y, of_one, of_depth = self.matrix.swapaxes(0, 1)
        center = of_x * x + of_y * y + of_one + of_depth * inverse_depth  # (3, B), homogeneous
        # the middles of the left and right side (in x), and of the upper and lower one (in y), over their depths as
        # shares of those before
        place, ratio = np.empty((2, 4, len(x)))
        for side, axis, half in ((0, 0, of_x * (width / 2)), (2, 1, of_y * (height / 2))):
            np.subtract(center[axis], half[axis], out=place[side])
            np.add(center[axis], half[axis], out=place[side + 1])
            np.subtract(center[2], half[2], out=ratio[side])
            np.add(center[2], half[2], out=ratio[side + 1])
        sound = ((ratio > _LEAST_DEPTH_RATIO) & (ratio < _MOST_DEPTH_RATIO)).all(axis=0)
        place /= np.where(sound, ratio, 1.0)
        moved = np.empty((4, len(x)))
        np.add(place[::2], place[1::2], out=moved[:2])
        moved[:2] *= 0.5
        np.subtract(place[1::2], place[::2], out=moved[2:])
        moved -= position
        moved *= sound
        return moved


@dataclass(frozen=True, eq=False)
class TracksMotion:
    """What a ``camera`` does to the tracks of a window: its rows are the window's frames, ``height_m`` (T,) is how tall
    the object of each track is."""

    camera: CameraMotion
    height_m: _Array

    def between(self, position: _Array, track: NDArray[np.int64], before: _Rows, after: _Rows) -> _Array:
        """(4, B) how far boxes (4, B) of tracks (B,) move from frames ``before`` (B,) to frames ``after`` (B,)."""
        count = len(self.camera.timestamp_ns)
        pairs, which = np.unique(before * count + after, return_inverse=True)  # many boxes go the same way
        steps = self.camera.steps(*np.divmod(pairs, count))[which]
        return steps.displacements(position, self.height_m[track])

    def into_frames(self, track: NDArray[np.int64], frame: NDArray[np.int64]) -> tuple[Steps, _Array]:
        """What boxes of tracks (N,) need to come into frames (N,) from the ones before: the steps, and heights (N,)."""
        every = np.arange(len(self.camera.timestamp_ns))
        return self.camera.steps(np.maximum(every - 1, 0), every)[frame], self.height_m[track]


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
