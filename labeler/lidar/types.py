"""What the LiDAR step says: 3D boxes of what one camera sees."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Boxes3D:
    """3D boxes made for one camera direction in one frame, a row each, in the ego frame at the sweep's time.

    ``center_m`` (N, 3) float32, ``size_m`` (N, 3) float32 as length, width, height, ``yaw_rad`` (N,) float32 about z,
    ``score`` (N,) float32 in 0..1, ``class_id`` (N,) int16, ``num_points`` (N,) int32 LiDAR points that the box was
    fitted to, ``detection_index`` (N,) int32: the row of the camera's Detections in that frame whose box painted the
    points.
    """

    center_m: NDArray[np.float32]
    size_m: NDArray[np.float32]
    yaw_rad: NDArray[np.float32]
    score: NDArray[np.float32]
    class_id: NDArray[np.int16]
    num_points: NDArray[np.int32]
    detection_index: NDArray[np.int32]

    def __post_init__(self) -> None:
        count = len(self.score)
        shapes = {"center_m": (count, 3), "size_m": (count, 3)}
        for name in ("center_m", "size_m", "yaw_rad", "class_id", "num_points", "detection_index"):
            shape = shapes.get(name, (count,))
            if getattr(self, name).shape != shape:
                raise ValueError(f"Boxes3D.{name} must have shape {shape}, got {getattr(self, name).shape}")

    def __len__(self) -> int:
        return len(self.score)

    def __getitem__(self, rows: NDArray[np.bool_] | NDArray[np.intp] | slice) -> Boxes3D:
        return Boxes3D(
            self.center_m[rows],
            self.size_m[rows],
            self.yaw_rad[rows],
            self.score[rows],
            self.class_id[rows],
            self.num_points[rows],
            self.detection_index[rows],
        )

    @staticmethod
    def empty() -> Boxes3D:
        return Boxes3D(
            np.zeros((0, 3), np.float32),
            np.zeros((0, 3), np.float32),
            np.zeros(0, np.float32),
            np.zeros(0, np.float32),
            np.zeros(0, np.int16),
            np.zeros(0, np.int32),
            np.zeros(0, np.int32),
        )
