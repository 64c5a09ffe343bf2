"""The pillar network: points to pillars, pillars to a map seen from above, the map to what stands in each cell.

As in PointPillars (arXiv:1812.05784) a linear layer and a maximum make 32 numbers of each pillar, which are laid out on
the grid. Depthwise separable convolutions go down to an eighth of its resolution and back up to half, where a head
without anchors (CenterPoint, arXiv:2006.11275) says of each cell whether the middle of a vehicle lies in it, and the
box.
"""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

import torch
from torch import Tensor, nn
from torch.nn.functional import interpolate

from labeler.lidar.pillars.decode import STRIDE, Outputs
from labeler.lidar.pillars.grouping import Grid, features_of
from labeler.training.devices import full_precision
from labeler.training.yolox_network import AddedUnit, Pointwise, Unit, unit_3x3

_PILLAR_CHANNELS = 32
_WIDTHS = (32, 64, 128)
_BLOCKS = (1, 2, 2)
_MERGED = 48
_PRIOR_LOGIT = -4.6
"""A hundredth: few cells hold the middle of a vehicle."""


def _level(shrink: nn.Module, channels: int, blocks: int) -> nn.Sequential:
    return nn.Sequential(shrink, *(AddedUnit(channels) for _ in range(blocks)))


class PillarNetwork(nn.Module):
    """(P, M, F) features of the points of pillars and (P,) their cells, of ``count`` clouds one after the other, to
    (N, C, rows / 2, columns / 2) as :class:`labeler.lidar.pillars.decode.Outputs` reads it. ``columns`` is how many
    columns a point has before it is grouped."""

    def __init__(self, columns: int, class_count: int) -> None:
        super().__init__()
        self.columns, self.class_count = columns, class_count
        self.of_points = nn.Linear(features_of(columns), _PILLAR_CHANNELS, bias=False)
        self.normalise = nn.BatchNorm1d(_PILLAR_CHANNELS, eps=1e-3, momentum=0.03)
        first = Unit(_PILLAR_CHANNELS, _WIDTHS[0], 3, stride=STRIDE)
        self.levels = nn.ModuleList([_level(first, _WIDTHS[0], _BLOCKS[0])])
        for before, after, blocks in zip(_WIDTHS[:-1], _WIDTHS[1:], _BLOCKS[1:], strict=True):
            self.levels.append(_level(unit_3x3(before, after, stride=2, depthwise=True), after, blocks))
        self.sides = nn.ModuleList(Pointwise(width, _MERGED) for width in _WIDTHS)
        self.smooth = nn.ModuleList(unit_3x3(_MERGED, _MERGED, depthwise=True) for _ in _WIDTHS[1:])
        self.shared = unit_3x3(_MERGED, _MERGED, depthwise=True)
        self.outputs = Pointwise(_MERGED, Outputs.channels(class_count))
        with torch.no_grad():
            bias = self.outputs.bias
            assert bias is not None
            bias.zero_()
            bias[Outputs.HEAT] = _PRIOR_LOGIT

    def forward(self, points: Tensor, cell: Tensor, grid: Grid, count: int = 1) -> Tensor:
        pillars, per_pillar, features = points.shape
        with full_precision(points.device):  # in half precision places would be off by decimetres
            told = self.normalise(self.of_points(points.reshape(-1, features))).relu()
        strongest = told.reshape(pillars, per_pillar, _PILLAR_CHANNELS).amax(dim=1)
        flat = strongest.new_zeros(count * grid.rows * grid.columns, _PILLAR_CHANNELS)
        flat = flat.index_put((cell,), strongest)
        x = flat.reshape(count, grid.rows, grid.columns, _PILLAR_CHANNELS).permute(0, 3, 1, 2)
        seen: list[Tensor] = []
        for level in self.levels:
            x = level(x)
            seen.append(x)
        merged = self.sides[-1](seen[-1])
        for index in reversed(range(len(seen) - 1)):
            larger = interpolate(merged, scale_factor=2.0, mode="bilinear", align_corners=False)
            merged = self.smooth[index](torch.relu(larger + self.sides[index](seen[index])))
        return self.outputs(self.shared(merged))
