"""What a detector says about an image."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Detections:
    """Boxes found in one image, by descending score.

    ``xyxy_px`` (N, 4) float32 in pixels of the original image, ``score`` (N,) float32 in 0..1 (objectness times class
    probability), ``class_id`` (N,) int16 as an index into the detector's ``class_names``.
    """

    xyxy_px: NDArray[np.float32]
    score: NDArray[np.float32]
    class_id: NDArray[np.int16]

    def __post_init__(self) -> None:
        count = len(self.score)
        if self.xyxy_px.shape != (count, 4) or self.score.shape != (count,) or self.class_id.shape != (count,):
            raise ValueError(
                f"Detections need xyxy_px (N, 4), score (N,) and class_id (N,), "
                f"got {self.xyxy_px.shape}, {self.score.shape} and {self.class_id.shape}"
            )

    def __len__(self) -> int:
        return len(self.score)

    def __getitem__(self, rows: NDArray[np.bool_] | NDArray[np.intp] | slice) -> Detections:
        return Detections(self.xyxy_px[rows], self.score[rows], self.class_id[rows])

    @staticmethod
    def empty() -> Detections:
        return Detections(np.zeros((0, 4), np.float32), np.zeros(0, np.float32), np.zeros(0, np.int16))


class Detector(Protocol):
    """Finds objects in images. ``detect`` may be called from several threads at once."""

    @property
    def class_names(self) -> tuple[str, ...]: ...

    @property
    def batch_size(self) -> int:
        """How many images ``detect`` takes best in one call."""
        ...

    def detect(self, images: Sequence[NDArray[np.uint8]]) -> list[Detections]:
        """One Detections for each (H, W, 3) uint8 image in BGR order; the images may differ in size."""
        ...
