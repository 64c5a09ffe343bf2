"""The cameras that see a drive, and where the car was in each frame: from images and ego frames to the world."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.drive.types import Camera


@dataclass(frozen=True, eq=False)
class Rig:
    """``cameras`` by name; ``timestamp_ns`` (F,) int64 of every frame of the drive; ``city_SE3_ego`` (F, 4, 4) float64
    the car's pose in each, None where the drive has no poses: then what is seen at different times can't be compared.
    """

    cameras: Mapping[str, Camera]
    timestamp_ns: NDArray[np.int64]
    city_SE3_ego: NDArray[np.float64] | None

    def __post_init__(self) -> None:
        if self.city_SE3_ego is not None and self.city_SE3_ego.shape != (len(self.timestamp_ns), 4, 4):
            raise ValueError(
                f"Rig.city_SE3_ego must have shape ({len(self.timestamp_ns)}, 4, 4), got {self.city_SE3_ego.shape}"
            )

    @staticmethod
    def of(cameras: Sequence[Camera], timestamp_ns: NDArray[np.int64], city_SE3_ego: NDArray[np.float64] | None) -> Rig:
        """The rig with these cameras."""
        return Rig({camera.name: camera for camera in cameras}, timestamp_ns, city_SE3_ego)

    def seconds(self, frame_index: int) -> float:
        """The time of a frame since the first."""
        return float(self.timestamp_ns[frame_index] - self.timestamp_ns[0]) / 1e9
