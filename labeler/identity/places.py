"""What one frame says about tracks: where each observation is in 3D, how sure that is, and where in its image.

All cameras of a frame are one table, so that comparing them is a few operations on arrays.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.drive.types import Camera
from labeler.identity.rig import Rig
from labeler.identity.types import CameraView, MultiCameraFrame

_FLOOR_M2 = 0.15**2
"""No place is surer than this: cameras and LiDAR are not calibrated to the centimetre."""
_EDGE_SHARE = 0.01


@dataclass(frozen=True, eq=False)
class Places:
    """The observations of one frame, a row each, cameras one after the other.

    ``track`` (N,) int32; ``camera`` (N,) int16, a number of the camera; ``group`` (N,) int64 of the class;
    ``xyxy_px`` (N, 4) float64; ``edge`` (N, 2) bool, whether the box touches the left and the right edge of its image;
    ``score`` (N,) float64, 0 where the tracker filled the box in; ``class_id`` (N,) int16. In the ego frame:
    ``xyz_m`` (N, 3) float64 the middle of the object, NaN where it is not known; ``cov_m2`` (N, 2, 2) float64 of x and
    y; ``size_m`` (N, 3) and ``yaw_rad`` (N,) float64 of the 3D box, NaN where there is none.
    """

    frame_index: int
    track: NDArray[np.int32]
    camera: NDArray[np.int16]
    group: NDArray[np.int64]
    xyxy_px: NDArray[np.float64]
    edge: NDArray[np.bool_]
    score: NDArray[np.float64]
    class_id: NDArray[np.int16]
    xyz_m: NDArray[np.float64]
    cov_m2: NDArray[np.float64]
    size_m: NDArray[np.float64]
    yaw_rad: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.track)

    @property
    def has_place(self) -> NDArray[np.bool_]:
        """(N,) whether it is known where the object is."""
        return np.isfinite(self.xyz_m[:, 0])

    @property
    def at_edge(self) -> NDArray[np.bool_]:
        """(N,) whether the box touches the left or the right edge of its image."""
        return self.edge[:, 0] | self.edge[:, 1]

    @property
    def has_box(self) -> NDArray[np.bool_]:
        """(N,) whether the observation has a 3D box."""
        return np.isfinite(self.yaw_rad)


def places_of(frame: MultiCameraFrame, rig: Rig, numbers: dict[str, int], class_groups: NDArray[np.int64]) -> Places:
    """The table of a frame. ``numbers`` gives each camera's number; a camera that it lacks is added.

    Raises ValueError for a class without a group."""
    parts = [
        _of_camera(view, rig.cameras.get(name), numbers.setdefault(name, len(numbers)))
        for name, view in sorted(frame.views.items())
    ]
    columns = [np.concatenate(column) for column in zip(_EMPTY, *parts, strict=True)]
    track, camera, xyxy_px, edge, score, class_id, xyz_m, cov_m2, size_m, yaw_rad = columns
    return Places(
        frame.frame_index, track, camera, _groups(class_id, class_groups), xyxy_px, edge, score, class_id,
        xyz_m, cov_m2, size_m, yaw_rad,
    )  # fmt: skip


_EMPTY = (
    np.zeros(0, np.int32), np.zeros(0, np.int16), np.zeros((0, 4)), np.zeros((0, 2), np.bool_), np.zeros(0),
    np.zeros(0, np.int16), np.zeros((0, 3)), np.zeros((0, 2, 2)), np.zeros((0, 3)), np.zeros(0),
)  # fmt: skip


def _groups(class_id: NDArray[np.int16], class_groups: NDArray[np.int64]) -> NDArray[np.int64]:
    unknown = class_id[(class_id < 0) | (class_id >= len(class_groups))]
    if len(unknown):
        raise ValueError(
            f"an observation has class {unknown[0]}, but class_groups holds {len(class_groups)} classes; "
            "give it a group for every class of the detector"
        )
    return class_groups[class_id]


def _of_camera(view: CameraView, camera: Camera | None, number: int) -> Sequence[NDArray[np.generic]]:
    observations, boxes = view.observations, view.boxes_3d
    count = len(observations)
    xyxy_px = observations.xyxy_px.astype(np.float64)
    edge = np.zeros((count, 2), np.bool_)
    xyz_m, size_m = np.full((count, 3), np.nan), np.full((count, 3), np.nan)
    yaw_rad, cov_m2 = np.full(count, np.nan), np.full((count, 2, 2), np.nan)
    if camera is not None:
        edge[:, 0] = xyxy_px[:, 0] <= _EDGE_SHARE * camera.width_px
        edge[:, 1] = xyxy_px[:, 2] >= (1 - _EDGE_SHARE) * camera.width_px
    if len(view.positions) and count:
        rows, position = _of_each(observations.detection_index, view.positions.detection_index)
        xyz_m[rows] = view.positions.position_m[position]
        cov_m2[rows] = view.positions.covariances()[position] + _FLOOR_M2 * np.eye(2)
    if len(boxes) and count:
        rows, box = _of_each(observations.detection_index, boxes.detection_index)
        size_m[rows], yaw_rad[rows] = boxes.size_m[box], boxes.yaw_rad[box]
    return (
        observations.track_id,
        np.full(count, number, np.int16),
        xyxy_px,
        edge,
        np.nan_to_num(observations.score.astype(np.float64)),
        observations.class_id,
        xyz_m,
        cov_m2,
        size_m,
        yaw_rad,
    )


def _of_each(
    detection_index: NDArray[np.int32], of_rows: NDArray[np.int32]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Rows of observations with a row in another table, and that row: both come from one detection."""
    order = np.argsort(of_rows, kind="stable")
    at = np.minimum(np.searchsorted(of_rows[order], detection_index), len(order) - 1)
    box = order[at]
    rows = np.flatnonzero((of_rows[box] == detection_index) & (detection_index >= 0))
    return rows, box[rows]
