"""The detector as a training task."""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

from collections import Counter
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
        crops: Sequence[CropConfig],
        shape: YoloxShape = NANO,
    ) -> None:
        """Examples are dealt out to ``crops`` in turn: what is named twice is drawn twice as often."""
        self.drives = drives
        self._crops, self._shape = tuple(crops), shape
        self._samplers = {config: CropSampler(pictures, config) for config in self._crops}

    def new_network(self) -> nn.Module:
        return Yolox(len(DETECTOR_CLASSES), self._shape)

    def loss(self, network: nn.Module, rng: np.random.Generator, count: int) -> Tensor:
        """The mean over the kinds of crops: a few large ones weigh as much as many small ones."""
        counts = Counter(self._crops[index % len(self._crops)] for index in range(count))
        losses = [
            self._loss_on(network, config, [self._samplers[config].draw(rng) for _ in range(number)])
            for config, number in counts.items()
        ]
        return torch.stack(losses).mean()

    @staticmethod
    def _loss_on(network: nn.Module, config: CropConfig, examples: Sequence[Picture]) -> Tensor:
        images = torch.from_numpy(np.stack([example.image for example in examples])).permute(0, 3, 1, 2).float()
        truths = [
            TrueObjects(
                torch.from_numpy(example.boxes_px),
                torch.from_numpy(example.classes),
                torch.from_numpy(example.ignored_px),
            )
            for example in examples
        ]
        return yolox_loss(network(images), truths, (config.height_px, config.width_px))
