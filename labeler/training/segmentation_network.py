"""A small network that says of each 4 x 4 pixels what they show.

Depthwise separable convolutions down to stride 32, where maxima over large windows bring in what is far, and back up to
stride 4, adding at each level what the way down saw there (the shape of T.-Y. Lin et al., "Feature Pyramid Networks for
Object Detection", arXiv:1612.03144, as A. Kirillov et al. use it for segmentation, arXiv:1901.02446).
"""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

import torch
from torch import Tensor, nn
from torch.nn.functional import interpolate

from labeler.training.yolox_network import AddedUnit, Pointwise, PyramidPooling, Unit, unit_3x3

STRIDE_PX = 4
_WIDTHS = (16, 32, 48, 96, 128)
_BLOCKS = (1, 2, 3, 2)
_MERGED = 48


def _level(channels_in: int, channels_out: int, blocks: int) -> nn.Sequential:
    shrink = unit_3x3(channels_in, channels_out, stride=2, depthwise=True)
    return nn.Sequential(shrink, *(AddedUnit(channels_out) for _ in range(blocks)))


class SegmentationNetwork(nn.Module):
    """(N, 3, H, W) float images in RGB order, 0 to 255, sides multiples of 32, to (N, C, H/4, W/4) logits. The cell in
    row i and column j describes the pixels of rows 4i to 4i + 3 and columns 4j to 4j + 3."""

    def __init__(self, class_count: int) -> None:
        super().__init__()
        self.class_count = class_count
        self.stem = Unit(3, _WIDTHS[0], 3, stride=2)
        self.levels = nn.ModuleList(
            _level(before, after, blocks)
            for before, after, blocks in zip(_WIDTHS[:-1], _WIDTHS[1:], _BLOCKS, strict=True)
        )
        self.context = PyramidPooling(_WIDTHS[-1])
        self.sides = nn.ModuleList(Pointwise(width, _MERGED) for width in _WIDTHS[1:])
        self.smooth = nn.ModuleList(unit_3x3(_MERGED, _MERGED, depthwise=True) for _ in _WIDTHS[2:])
        self.classes = Pointwise(_MERGED, class_count)

    def forward(self, images: Tensor) -> Tensor:
        x = self.stem(images)
        seen: list[Tensor] = []
        for level in self.levels:
            x = level(x)
            seen.append(x)
        seen[-1] = self.context(x)
        merged = self.sides[-1](seen[-1])
        for index in reversed(range(len(seen) - 1)):
            larger = interpolate(merged, scale_factor=2.0, mode="bilinear", align_corners=False)
            merged = self.smooth[index](torch.relu(larger + self.sides[index](seen[index])))
        return self.classes(merged)
