"""Semantic segmentation as a training task."""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn.functional import avg_pool2d

from labeler.training.assignment import one_of
from labeler.training.crops import CropConfig, CropSampler
from labeler.training.devices import half_precision, on_device
from labeler.training.errors import TrainingError
from labeler.training.pictures import SEGMENTATION_CLASSES, Picture
from labeler.training.segmentation_network import STRIDE_PX, SegmentationNetwork

SegmentationExample = tuple[NDArray[np.uint8], NDArray[np.uint8]]
"""An image (H, W, 3), BGR, and the class of each pixel (H, W)."""


class SegmentationTask:
    """The share of each class in each 4 x 4 pixels, learned by cross entropy: where an edge runs through a cell, the
    answer asked for is how much of it lies on either side."""

    def __init__(self, pictures: Sequence[Picture], drives: Sequence[str], crops: CropConfig) -> None:
        """TrainingError when a picture does not say what its pixels show."""
        if any(picture.semantic is None for picture in pictures):
            raise TrainingError(
                "There are drives without the class of each pixel. Record them with hindsight simulate --semantic."
            )
        self.drives = drives
        self._sampler = CropSampler(pictures, crops)

    def new_network(self) -> nn.Module:
        return SegmentationNetwork(len(SEGMENTATION_CLASSES))

    def examples(self, rng: np.random.Generator, numbers: range) -> list[SegmentationExample]:
        drawn = [self._sampler.draw(rng) for _ in numbers]
        return [(example.image, example.semantic) for example in drawn if example.semantic is not None]

    def batch(self, examples: Sequence[SegmentationExample], device: torch.device) -> tuple[Tensor, Tensor]:
        """(N, 3, H, W) uint8 images in RGB order, and the class of each pixel (N, H, W) uint8."""
        images = np.stack([image[:, :, ::-1] for image, _ in examples])
        classes = np.stack([semantic for _, semantic in examples])
        return on_device(images, device).permute(0, 3, 1, 2), on_device(classes, device)

    def loss(self, network: nn.Module, batch: tuple[Tensor, Tensor]) -> Tensor:
        images, classes = batch
        shares = one_of(classes, len(SEGMENTATION_CLASSES)).permute(0, 3, 1, 2).float()
        with half_precision(images.device):
            logits: Tensor = network(images.float())
        return nn.functional.cross_entropy(logits.float(), avg_pool2d(shares, STRIDE_PX))
