"""An image into the network's input and boxes back: resized, put into the upper left corner, the rest filled with 114.

YOLOX was trained so: BGR, 0..255, no normalisation."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from labeler.detection.config import LARGEST_STRIDE_PX

PAD_VALUE = 114


@dataclass(frozen=True)
class Letterbox:
    """How an image of ``image_hw`` lies in an input of ``input_hw``: as its upper left ``placed_hw`` pixels."""

    image_hw: tuple[int, int]
    input_hw: tuple[int, int]
    placed_hw: tuple[int, int]

    @property
    def input_per_image(self) -> NDArray[np.float32]:
        """(4,) float32 scales that take a box x1, y1, x2, y2 in image pixels to input pixels."""
        scale_x, scale_y = self.placed_hw[1] / self.image_hw[1], self.placed_hw[0] / self.image_hw[0]
        return np.array([scale_x, scale_y, scale_x, scale_y], np.float32)

    def write(self, image: NDArray[np.uint8], planes: NDArray[np.float32]) -> None:
        """Fill ``planes``, (3, H, W) float32 with H, W of the input, from an (H, W, 3) uint8 image of ``image_hw``."""
        height, width = self.placed_hw
        if self.placed_hw != self.image_hw:
            image = np.asarray(cv2.resize(image, (width, height), interpolation=cv2.INTER_LINEAR), np.uint8)
        # Splitting first makes each copy contiguous: a third of the time of transposing (0.3 ms for 1242x375).
        for plane, channel in zip(planes, cv2.split(image), strict=True):
            plane[:height, :width] = channel
        planes[:, height:] = PAD_VALUE
        planes[:, :height, width:] = PAD_VALUE

    def to_image(self, xyxy_input_px: NDArray[np.float32]) -> NDArray[np.float32]:
        """(N, 4) boxes in pixels of the input to pixels of the image; not clipped."""
        return xyxy_input_px / self.input_per_image

    def to_input(self, xyxy_px: NDArray[np.float32]) -> NDArray[np.float32]:
        """(N, 4) boxes in pixels of the image to pixels of the input."""
        return xyxy_px * self.input_per_image


def fit_letterbox(image_hw: tuple[int, int], *, height: int | None, width: int | None, long_side_px: int) -> Letterbox:
    """The letterbox of an image for a network whose input has this ``height`` and ``width``; None is a free side.

    Fixed sides: the image is scaled, up or down, to fit. With a free side the image's longer side becomes
    ``long_side_px`` at most and the image is never enlarged; free sides follow the image, rounded up to 32.
    """
    image_height, image_width = image_hw
    limits = [side / own for side, own in ((height, image_height), (width, image_width)) if side is not None]
    if height is None or width is None:
        limits += [1.0, long_side_px / max(image_hw)]
    scale = min(limits)
    placed = _at_least_1(image_height * scale), _at_least_1(image_width * scale)
    return Letterbox(image_hw, (height or _round_up(placed[0]), width or _round_up(placed[1])), placed)


def _at_least_1(side_px: float) -> int:
    return max(1, round(side_px))


def _round_up(side_px: int) -> int:
    return -(-side_px // LARGEST_STRIDE_PX) * LARGEST_STRIDE_PX
