"""The detector as a training task."""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor, nn

from labeler.training.crops import CropConfig, CropSampler
from labeler.training.pictures import DETECTOR_CLASSES, Picture
from labeler.training.yolox_loss import TrueObjects, yolox_loss
from labeler.training.yolox_network import NANO, Yolox, YoloxShape


class DetectorTask:
    """Visible boxes and classes of vehicles."""

    def __init__(
        self,
        pictures: Sequence[Picture],
        drives: Sequence[str],
        crops: CropConfig,
        shape: YoloxShape = NANO,
    ) -> None:
        self.drives = drives
        self._crops = crops
        self._sampler, self._shape = CropSampler(pictures, self._crops), shape

    def new_network(self) -> nn.Module:
        return Yolox(len(DETECTOR_CLASSES), self._shape)

    def loss(self, network: nn.Module, rng: np.random.Generator, count: int) -> Tensor:
        examples = [self._sampler.draw(rng) for _ in range(count)]
        images = torch.from_numpy(np.stack([example.image for example in examples])).permute(0, 3, 1, 2).float()
        truths = [
            TrueObjects(
                torch.from_numpy(example.boxes_px),
                torch.from_numpy(example.classes),
                torch.from_numpy(example.ignored_px),
            )
            for example in examples
        ]
        return yolox_loss(network(images), truths, (self._crops.height_px, self._crops.width_px))
