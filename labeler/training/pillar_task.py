"""The pillar network as a training task, on painted points or on the same points without their paint."""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor, nn

from labeler.lidar.pillars.direction import PAINTED_CLASSES, columns_for
from labeler.lidar.pillars.grouping import pillars_of
from labeler.training.cloud_examples import CloudSampler
from labeler.training.clouds import PILLAR_CLASSES, DirectionSweep
from labeler.training.pillar_loss import pillar_loss
from labeler.training.pillar_network import PillarNetwork
from labeler.training.pillar_targets import targets_of

WINDOW_CELLS = (64, 64)


class PillarTask:
    """Vehicles in windows of clouds. ``painted`` False leaves out what the image says, to show what it is worth."""

    def __init__(
        self,
        sweeps: Sequence[DirectionSweep],
        drives: Sequence[str],
        *,
        painted: bool = True,
        window_cells: tuple[int, int] = WINDOW_CELLS,
    ) -> None:
        self.drives = drives
        self._columns = columns_for(PAINTED_CLASSES if painted else ())
        self._sampler = CloudSampler(sweeps, rows=window_cells[0], columns=window_cells[1])

    def new_network(self) -> nn.Module:
        return PillarNetwork(self._columns, len(PILLAR_CLASSES))

    def loss(self, network: nn.Module, rng: np.random.Generator, count: int) -> Tensor:
        examples = [self._sampler.draw(rng) for _ in range(count)]
        grid = examples[0].grid
        pillars = [pillars_of(example.cloud[:, : self._columns], example.grid) for example in examples]
        cells = grid.rows * grid.columns
        cell = np.concatenate([group.cell + number * cells for number, group in enumerate(pillars)])
        points = np.concatenate([group.points for group in pillars])
        output: Tensor = network(torch.from_numpy(points), torch.from_numpy(cell), grid, count)
        return pillar_loss(output, [targets_of(example) for example in examples])
