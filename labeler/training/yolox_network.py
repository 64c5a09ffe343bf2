"""The YOLOX network: CSPDarknet, a path-aggregating feature pyramid, and a head that decouples class and box.

Z. Ge et al., "YOLOX: Exceeding YOLO Series in 2021" (arXiv:2107.08430); the cross-stage partial blocks are those of
arXiv:1911.11929, the pyramid that of arXiv:1803.01534. ``NANO`` has the paper's depth, width and depthwise
convolutions. Two things differ, for the sake of a CPU: ReLU stands for SiLU, because onnxruntime computes it inside the
convolution; and the first convolution is 3 x 3 at stride 2 instead of the paper's focus (2 x 2 pixels into one, then 3
x 3), which would take a third of the whole network's time.
"""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor, nn

STRIDES_PX = (8, 16, 32)
_BATCH_NORM_EPS, _BATCH_NORM_MOMENTUM = 1e-3, 0.03
_PRIOR_PROBABILITY = 0.01
_POOL_SIZES = (5, 9, 13)


@dataclass(frozen=True)
class YoloxShape:
    """How deep and wide: factors of the paper's largest network; ``depthwise`` splits 3 x 3 convolutions in two."""

    depth: float
    width: float
    depthwise: bool

    def channels(self, of_largest: int) -> int:
        return int(of_largest * self.width)

    def blocks(self, of_largest: int) -> int:
        return max(round(of_largest * self.depth), 1)


NANO = YoloxShape(depth=0.33, width=0.25, depthwise=True)


class Pointwise(nn.Conv2d):
    """A 1 x 1 convolution. In training it is computed as the matrix product that it is: on one core, and with the
    channels last in memory, that is three times as quick as torch's convolution."""

    def __init__(self, channels_in: int, channels_out: int, *, bias: bool = True) -> None:
        super().__init__(channels_in, channels_out, 1, bias=bias)

    def forward(self, input: Tensor) -> Tensor:  # noqa: A002, the name that torch gives it
        if not self.training:
            return super().forward(input)
        pixels = input.permute(0, 2, 3, 1)
        return nn.functional.linear(pixels, self.weight.flatten(1), self.bias).permute(0, 3, 1, 2)


class Unit(nn.Sequential):
    """Convolution, batch normalisation, ReLU."""

    def __init__(self, channels_in: int, channels_out: int, size: int, *, stride: int = 1, groups: int = 1) -> None:
        if size == 1:
            convolution = Pointwise(channels_in, channels_out, bias=False)
        else:
            convolution = nn.Conv2d(channels_in, channels_out, size, stride, size // 2, groups=groups, bias=False)
        normalisation = nn.BatchNorm2d(channels_out, eps=_BATCH_NORM_EPS, momentum=_BATCH_NORM_MOMENTUM)
        super().__init__(convolution, normalisation, nn.ReLU(inplace=True))


def unit_3x3(channels_in: int, channels_out: int, *, stride: int = 1, depthwise: bool) -> nn.Module:
    """A 3 x 3 unit; a depthwise one is followed by a 1 x 1 unit that mixes the channels."""
    if not depthwise:
        return Unit(channels_in, channels_out, 3, stride=stride)
    return nn.Sequential(
        Unit(channels_in, channels_in, 3, stride=stride, groups=channels_in), Unit(channels_in, channels_out, 1)
    )


class AddedUnit(nn.Module):
    """A depthwise 3 x 3 unit, added to what came in."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.unit = unit_3x3(channels, channels, depthwise=True)

    def forward(self, x: Tensor) -> Tensor:
        return x + self.unit(x)


class _Bottleneck(nn.Module):
    def __init__(self, channels: int, *, shortcut: bool, depthwise: bool) -> None:
        super().__init__()
        self.reduce = Unit(channels, channels, 1)
        self.spread = unit_3x3(channels, channels, depthwise=depthwise)
        self.shortcut = shortcut

    def forward(self, x: Tensor) -> Tensor:
        y = self.spread(self.reduce(x))
        return x + y if self.shortcut else y


class CrossStage(nn.Module):
    """Half of the channels goes through bottlenecks, half past them; both are mixed again."""

    def __init__(self, channels_in: int, channels_out: int, blocks: int, *, shortcut: bool, depthwise: bool) -> None:
        super().__init__()
        half = channels_out // 2
        self.through = Unit(channels_in, half, 1)
        self.past = Unit(channels_in, half, 1)
        self.blocks = nn.Sequential(*(_Bottleneck(half, shortcut=shortcut, depthwise=depthwise) for _ in range(blocks)))
        self.mix = Unit(2 * half, channels_out, 1)

    def forward(self, x: Tensor) -> Tensor:
        return self.mix(torch.cat([self.blocks(self.through(x)), self.past(x)], dim=1))


class PyramidPooling(nn.Module):
    """Maxima over windows of several sizes beside the input, so that the deepest level sees far."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        half = channels // 2
        self.reduce = Unit(channels, half, 1)
        self.pools = nn.ModuleList(nn.MaxPool2d(size, 1, size // 2) for size in _POOL_SIZES)
        self.mix = Unit(half * (1 + len(_POOL_SIZES)), channels, 1)

    def forward(self, x: Tensor) -> Tensor:
        x = self.reduce(x)
        return self.mix(torch.cat([x, *(pool(x) for pool in self.pools)], dim=1))


class _Backbone(nn.Module):
    """Features at strides 8, 16 and 32."""

    def __init__(self, shape: YoloxShape) -> None:
        super().__init__()
        wide = [shape.channels(c) for c in (64, 128, 256, 512, 1024)]
        deep = [shape.blocks(b) for b in (3, 9, 9, 3)]

        def shrink(level: int) -> nn.Module:
            return unit_3x3(wide[level], wide[level + 1], stride=2, depthwise=shape.depthwise)

        def stage(level: int, *, shortcut: bool = True) -> nn.Module:
            width = wide[level + 1]
            return CrossStage(width, width, deep[level], shortcut=shortcut, depthwise=shape.depthwise)

        self.to_8 = nn.Sequential(Unit(3, wide[0], 3, stride=2), shrink(0), stage(0), shrink(1), stage(1))
        self.to_16 = nn.Sequential(shrink(2), stage(2))
        self.to_32 = nn.Sequential(shrink(3), PyramidPooling(wide[4]), stage(3, shortcut=False))

    def forward(self, image: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        at_8 = self.to_8(image)
        at_16 = self.to_16(at_8)
        return at_8, at_16, self.to_32(at_16)


class _Pyramid(nn.Module):
    """What deep levels know goes up to the fine ones, and from there down again."""

    def __init__(self, shape: YoloxShape) -> None:
        super().__init__()
        c8, c16, c32 = (shape.channels(c) for c in (256, 512, 1024))
        blocks, depthwise = shape.blocks(3), shape.depthwise

        def join(channels_in: int, channels_out: int) -> nn.Module:
            return CrossStage(channels_in, channels_out, blocks, shortcut=False, depthwise=depthwise)

        self.narrow_32, self.up_16 = Unit(c32, c16, 1), join(2 * c16, c16)
        self.narrow_16, self.up_8 = Unit(c16, c8, 1), join(2 * c8, c8)
        self.shrink_8, self.down_16 = unit_3x3(c8, c8, stride=2, depthwise=depthwise), join(2 * c8, c16)
        self.shrink_16, self.down_32 = unit_3x3(c16, c16, stride=2, depthwise=depthwise), join(2 * c16, c32)

    def forward(self, at_8: Tensor, at_16: Tensor, at_32: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        narrow_32 = self.narrow_32(at_32)
        narrow_16 = self.narrow_16(self.up_16(torch.cat([_doubled(narrow_32), at_16], dim=1)))
        out_8 = self.up_8(torch.cat([_doubled(narrow_16), at_8], dim=1))
        out_16 = self.down_16(torch.cat([self.shrink_8(out_8), narrow_16], dim=1))
        out_32 = self.down_32(torch.cat([self.shrink_16(out_16), narrow_32], dim=1))
        return out_8, out_16, out_32


class Head(nn.Module):
    """One level's cells: box, objectness and classes, from two branches."""

    def __init__(self, channels_in: int, shape: YoloxShape, class_count: int) -> None:
        super().__init__()
        width = shape.channels(256)

        def branch() -> nn.Module:
            return nn.Sequential(*(unit_3x3(width, width, depthwise=shape.depthwise) for _ in range(2)))

        self.stem = Unit(channels_in, width, 1)
        self.box_branch, self.class_branch = branch(), branch()
        self.box, self.objectness = Pointwise(width, 4), Pointwise(width, 1)
        self.classes = Pointwise(width, class_count)
        for predictor in (self.objectness, self.classes):
            bias = predictor.bias
            assert bias is not None
            nn.init.constant_(bias, -math.log((1 - _PRIOR_PROBABILITY) / _PRIOR_PROBABILITY))

    def forward(self, x: Tensor) -> Tensor:
        x = self.stem(x)
        for_box = self.box_branch(x)
        return torch.cat([self.box(for_box), self.objectness(for_box), self.classes(self.class_branch(x))], dim=1)


class Yolox(nn.Module):
    """(N, 3, H, W) float images in BGR order, 0 to 255, sides multiples of 32, to (N, A, 5 + C) float cells.

    A row is one cell of the grids of strides 8, 16 and 32 in this order, row by row: ``(x - column, y - row)`` of the
    box's middle in strides, logarithm of width and height in strides, then logits of objectness and of the classes."""

    def __init__(self, class_count: int, shape: YoloxShape = NANO) -> None:
        super().__init__()
        self.class_count = class_count
        self.backbone, self.pyramid = _Backbone(shape), _Pyramid(shape)
        self.heads = nn.ModuleList(Head(shape.channels(c), shape, class_count) for c in (256, 512, 1024))

    def forward(self, images: Tensor) -> Tensor:
        levels = self.pyramid(*self.backbone(images))
        cells = [head(level).flatten(2) for head, level in zip(self.heads, levels, strict=True)]
        return torch.cat(cells, dim=2).transpose(1, 2)


def _doubled(x: Tensor) -> Tensor:
    return nn.functional.interpolate(x, scale_factor=2.0, mode="nearest")
