"""The pillar network as a training task, on painted points or on the same points without their paint."""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor, nn

from labeler.lidar.pillars.direction import PAINTED_CLASSES, columns_for
from labeler.lidar.pillars.grouping import Grid, Pillars, pillars_of
from labeler.training.cloud_examples import CloudSampler
from labeler.training.clouds import PILLAR_CLASSES, DirectionSweep
from labeler.training.devices import half_precision, on_device
from labeler.training.pillar_loss import AskedOfCells, pillar_loss
from labeler.training.pillar_network import PillarNetwork
from labeler.training.pillar_targets import PillarTargets, targets_of

WINDOW_CELLS = (64, 64)


@dataclass(frozen=True, eq=False)
class PillarExample:
    """A window, grouped, and what the network shall answer for it."""

    pillars: Pillars
    targets: PillarTargets
    grid: Grid


@dataclass(frozen=True, eq=False)
class PillarBatch:
    """``count`` windows of one size on a device, one after the other: ``points`` (P, M, F) of their pillars, and the
    ``cell`` (P,) of each among the cells of all."""

    points: Tensor
    cell: Tensor
    grid: Grid
    count: int
    asked: AskedOfCells


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

    def examples(self, rng: np.random.Generator, numbers: range) -> list[PillarExample]:
        drawn = [self._sampler.draw(rng) for _ in numbers]
        return [
            PillarExample(pillars_of(each.cloud[:, : self._columns], each.grid), targets_of(each), each.grid)
            for each in drawn
        ]

    def batch(self, examples: Sequence[PillarExample], device: torch.device) -> PillarBatch:
        grid = examples[0].grid
        cells = grid.rows * grid.columns
        cell = np.concatenate([example.pillars.cell + number * cells for number, example in enumerate(examples)])
        points = np.concatenate([example.pillars.points for example in examples])
        asked = AskedOfCells.of([example.targets for example in examples], device)
        return PillarBatch(on_device(points, device), on_device(cell, device), grid, len(examples), asked)

    def loss(self, network: nn.Module, batch: PillarBatch) -> Tensor:
        with half_precision(batch.points.device):
            output: Tensor = network(batch.points, batch.cell, batch.grid, batch.count)
        return pillar_loss(output.float(), batch.asked)
