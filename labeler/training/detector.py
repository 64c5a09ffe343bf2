"""The detector as a training task."""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from torch import Tensor, nn

from labeler.training.crops import CropConfig, CropSampler
from labeler.training.devices import half_precision, on_device
from labeler.training.pictures import DETECTOR_CLASSES, Picture
from labeler.training.yolox_loss import TrueObjects, yolox_loss
from labeler.training.yolox_network import NANO, Yolox, YoloxShape


@dataclass(frozen=True, eq=False)
class Crops:
    """Examples of one size on a device: ``images`` (N, 3, H, W) uint8, and what they show."""

    images: Tensor
    truth: TrueObjects


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
        bare = [replace(picture, semantic=None) for picture in pictures]  # cutting it as well would take time
        self._samplers = {config: CropSampler(bare, config) for config in self._crops}

    def new_network(self) -> nn.Module:
        return Yolox(len(DETECTOR_CLASSES), self._shape)

    def examples(self, rng: np.random.Generator, numbers: range) -> list[Picture]:
        dealt = [self._crops[number % len(self._crops)] for number in numbers]
        in_order = [config for kind in dict.fromkeys(dealt) for config in dealt if config == kind]
        return [self._samplers[config].draw(rng) for config in in_order]

    def batch(self, examples: Sequence[Picture], device: torch.device) -> list[Crops]:
        of_size: dict[tuple[int, ...], list[Picture]] = {}
        for example in examples:
            of_size.setdefault(example.image.shape, []).append(example)
        return [
            Crops(
                on_device(np.stack([picture.image for picture in pictures]), device).permute(0, 3, 1, 2),
                TrueObjects.of(pictures, device),
            )
            for pictures in of_size.values()
        ]

    def loss(self, network: nn.Module, batch: Sequence[Crops]) -> Tensor:
        """The mean over the sizes of crops: a few large ones weigh as much as many small ones."""
        with half_precision(batch[0].images.device):
            outputs: list[Tensor] = [network(crops.images.float()) for crops in batch]
        return torch.stack(
            [
                yolox_loss(cells.float(), crops.truth, (crops.images.shape[2], crops.images.shape[3]))
                for cells, crops in zip(outputs, batch, strict=True)
            ]
        ).mean()
