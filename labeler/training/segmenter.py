"""Semantic segmentation as a training task."""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn.functional import avg_pool2d, one_hot

from labeler.training.crops import CropConfig, CropSampler
from labeler.training.errors import TrainingError
from labeler.training.pictures import SEGMENTATION_CLASSES, Picture
from labeler.training.segmentation_network import STRIDE_PX, SegmentationNetwork


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

    def loss(self, network: nn.Module, rng: np.random.Generator, count: int) -> Tensor:
        examples = [self._sampler.draw(rng) for _ in range(count)]
        images = torch.from_numpy(np.stack([example.image[:, :, ::-1] for example in examples]))
        classes = torch.from_numpy(np.stack([example.semantic for example in examples if example.semantic is not None]))
        shares = one_hot(classes.long(), len(SEGMENTATION_CLASSES)).permute(0, 3, 1, 2).float()
        logits = network(images.permute(0, 3, 1, 2).float())
        return nn.functional.cross_entropy(logits, avg_pool2d(shares, STRIDE_PX))
