"""Pairs of tracks of two cameras seen at the same time: are they at the same place, frame by frame?

In each frame all places are compared with all of other cameras at once. What is far apart is only counted, since it
tells that two tracks are two objects; of what is near, sums are kept, and the few frames that agree best. So memory
grows with pairs of tracks and not with frames.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from labeler.drive.types import Camera
from labeler.geometry.boxes_3d import iou_3d
from labeler.geometry.se3 import invert_se3
from labeler.identity.places import Places
from labeler.identity.types import SharedFrame

NEAR_SIGMAS = 6.0
AGREEING_SIGMAS = 2.5
_NEAR_M = 6.0
_STACKED_M = 3.0
_CAPPED_SIGMAS = 7.0
_CAPPED_OUTSIDE = 2.0
_FAR_SIGMAS, _FAR_M = 8.0, 8.0


@dataclass(frozen=True, eq=False)
class BestFrame:
    """A frame in which two tracks are near: its Mahalanobis distance, and both boxes as x, y, z, length, width, height,
    yaw (7,) in the ego frame; NaN where there is no box."""

    sigmas: float
    frame_index: int
    distance_m: float
    box_a: NDArray[np.float64]
    box_b: NDArray[np.float64]

    def shared(self) -> SharedFrame:
        """As evidence; without boxes the overlaps are 0."""
        if not (np.isfinite(self.box_a).all() and np.isfinite(self.box_b).all()):
            return SharedFrame(self.frame_index, self.distance_m, 0.0, 0.0)
        a, b = self.box_a, self.box_b
        volume_iou, bev_iou = iou_3d(a[:3], a[3:6], float(a[6]), b[:3], b[3:6], float(b[6]))
        return SharedFrame(self.frame_index, self.distance_m, bev_iou, volume_iou)


@dataclass
class Together:
    """Sums over the frames in which two tracks have places near each other."""

    first_frame: int
    last_frame: int
    near_frames: int = 0
    agreeing_frames: int = 0
    nearest_frames: int = 0
    sigmas2_sum: float = 0.0
    distance_sum_m: float = 0.0
    agreeing_distance_sum_m: float = 0.0
    log_uncertainty_sum: float = 0.0
    outside_sum: float = 0.0
    best: list[BestFrame] = field(default_factory=list[BestFrame])


class PairBook:
    """All pairs of tracks of two cameras that were seen at the same time."""

    def __init__(self, cameras: Mapping[str, Camera], numbers: Mapping[str, int], *, best_frames: int) -> None:
        self.near: dict[tuple[int, int], Together] = {}
        self.far_frames: dict[tuple[int, int], int] = {}
        self._cameras = cameras
        self._numbers = numbers
        self._best_frames = best_frames
        self._projections: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None

    def apart(self, track_a: int, track_b: int) -> int:
        """In how many frames the two are surely at different places."""
        return self.far_frames.get((min(track_a, track_b), max(track_a, track_b)), 0)

    def mostly_apart(self, track_a: int, track_b: int) -> bool:
        """Whether the two were surely at different places in more frames than they were near each other in."""
        near = self.near.get((min(track_a, track_b), max(track_a, track_b)))
        return self.apart(track_a, track_b) > (0 if near is None else near.near_frames)

    def add(self, places: Places) -> None:
        """Compare the places of one frame."""
        rows = np.flatnonzero(places.has_place)
        if len(rows) < 2:
            return
        camera, track, group = places.camera[rows], places.track[rows], places.group[rows]
        xy_m, cov_m2, z_m = places.xyz_m[rows, :2], places.cov_m2[rows], places.xyz_m[rows, 2]
        possible = (camera[:, None] != camera[None, :]) & (group[:, None] == group[None, :])
        off = xy_m[:, None] - xy_m[None, :]
        distance_m = np.hypot(off[..., 0], off[..., 1])
        xx, xy, yy = (cov_m2[:, None, i, j] + cov_m2[None, :, i, j] for i, j in ((0, 0), (0, 1), (1, 1)))
        determinant = xx * yy - xy * xy
        sigmas2 = (yy * off[..., 0] ** 2 - 2 * xy * off[..., 0] * off[..., 1] + xx * off[..., 1] ** 2) / determinant
        stacked = np.abs(z_m[:, None] - z_m[None, :]) > _STACKED_M
        sigmas = np.where(possible & ~stacked, np.sqrt(np.maximum(sigmas2, 0)), np.inf)
        nearest = self._is_nearest(sigmas, camera)
        upper = possible & (track[:, None] < track[None, :])
        far = upper & ((stacked & (distance_m > 1)) | ((sigmas > _FAR_SIGMAS) & (distance_m > _FAR_M)))
        self._count_far(track[np.nonzero(far)[0]], track[np.nonzero(far)[1]])
        a, b = np.nonzero(upper & ((sigmas < NEAR_SIGMAS) | ((distance_m < _NEAR_M) & (sigmas < np.inf))))
        if not len(a):
            return
        outside = (self._outside(places, rows[a], rows[b]) + self._outside(places, rows[b], rows[a])) / 2
        both_nearest = nearest[a, b] & nearest[b, a]
        uncertainty = np.log(determinant[a, b]) / 4
        for number, (i, j) in enumerate(zip(a.tolist(), b.tolist(), strict=True)):
            self._add_near(
                places,
                int(rows[i]),
                int(rows[j]),
                sigmas=float(sigmas[i, j]),
                distance_m=float(distance_m[i, j]),
                is_nearest=bool(both_nearest[number]),
                log_uncertainty=float(uncertainty[number]),
                outside=float(outside[number]),
            )

    def _is_nearest(self, sigmas: NDArray[np.float64], camera: NDArray[np.int16]) -> NDArray[np.bool_]:
        """(M, M) whether column j is the nearest to row i among those of j's camera."""
        nearest = np.zeros(sigmas.shape, np.bool_)
        for number in np.unique(camera):
            columns = np.flatnonzero(camera == number)
            best = sigmas[:, columns].argmin(axis=1)
            nearest[np.arange(len(sigmas)), columns[best]] = True
        return nearest & np.isfinite(sigmas)

    def _count_far(self, track_a: NDArray[np.int32], track_b: NDArray[np.int32]) -> None:
        far = self.far_frames
        for key in zip(track_a.tolist(), track_b.tolist(), strict=True):
            far[key] = far.get(key, 0) + 1

    def _add_near(
        self,
        places: Places,
        row_a: int,
        row_b: int,
        *,
        sigmas: float,
        distance_m: float,
        is_nearest: bool,
        log_uncertainty: float,
        outside: float,
    ) -> None:
        key = (int(places.track[row_a]), int(places.track[row_b]))
        frame = places.frame_index
        pair = self.near.get(key)
        if pair is None:
            pair = self.near[key] = Together(frame, frame)
        pair.last_frame = frame
        pair.near_frames += 1
        pair.nearest_frames += is_nearest
        pair.sigmas2_sum += min(sigmas, _CAPPED_SIGMAS) ** 2
        pair.distance_sum_m += distance_m
        pair.log_uncertainty_sum += log_uncertainty
        pair.outside_sum += outside
        if sigmas < AGREEING_SIGMAS:
            pair.agreeing_frames += 1
            pair.agreeing_distance_sum_m += distance_m
        if len(pair.best) < self._best_frames or sigmas < pair.best[-1].sigmas:
            pair.best.append(BestFrame(sigmas, frame, distance_m, _box(places, row_a), _box(places, row_b)))
            pair.best.sort(key=lambda best: (best.sigmas, best.frame_index))
            del pair.best[self._best_frames :]

    def _outside(self, places: Places, own: NDArray[np.intp], other: NDArray[np.intp]) -> NDArray[np.float64]:
        """(P,) how far the other's place lies outside of the own box in the own image, in halves of the box's width; 0
        within it, and beyond an edge of the image that cuts the box."""
        camera_SE3_ego, intrinsics = self._projection_matrices()
        number = places.camera[own]
        turned = np.einsum("nij,nj->ni", camera_SE3_ego[number, :3, :3], places.xyz_m[other])
        point_m = turned + camera_SE3_ego[number, :3, 3]
        depth_m = np.maximum(point_m[:, 2], 0.1)
        x_px = intrinsics[number, 0] * point_m[:, 0] / depth_m + intrinsics[number, 1]
        left_px, right_px = places.xyxy_px[own, 0], places.xyxy_px[own, 2]
        half_px = np.maximum((right_px - left_px) / 2, 1.0)
        beyond_left = np.where(places.edge[own, 0], 0.0, (left_px - x_px) / half_px)
        beyond_right = np.where(places.edge[own, 1], 0.0, (x_px - right_px) / half_px)
        outside = np.clip(np.maximum(beyond_left, beyond_right), 0, _CAPPED_OUTSIDE)
        return np.where(point_m[:, 2] > 0.1, outside, np.where(places.at_edge[own], 0.5, _CAPPED_OUTSIDE))

    def _projection_matrices(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(C, 4, 4) ``camera_SE3_ego`` and (C, 2) focal length and middle in x, by number of the camera."""
        if self._projections is None or len(self._projections[0]) != len(self._numbers):
            poses, intrinsics = np.tile(np.eye(4), (len(self._numbers), 1, 1)), np.ones((len(self._numbers), 2))
            for name, number in self._numbers.items():
                camera = self._cameras.get(name)
                if camera is not None and camera.calibration is not None:
                    poses[number] = invert_se3(camera.calibration.ego_SE3_camera)
                    intrinsics[number] = camera.calibration.intrinsics[0, [0, 2]]
            self._projections = poses, intrinsics
        return self._projections


def pairs_worth_a_look(pairs: PairBook) -> Iterator[tuple[tuple[int, int], Together, int]]:
    """(tracks, sums, frames far apart) of each pair that was ever near, in order of the tracks."""
    for key in sorted(pairs.near):
        yield key, pairs.near[key], pairs.far_frames.get(key, 0)


def mean_bev_iou(frames: Sequence[SharedFrame]) -> float | None:
    """The mean over frames; None without any."""
    return math.fsum(frame.bev_iou for frame in frames) / len(frames) if frames else None


def _box(places: Places, row: int) -> NDArray[np.float64]:
    return np.array([*places.xyz_m[row], *places.size_m[row], places.yaw_rad[row]])
