"""The loss of the pillar network: where vehicles are by focal loss, their boxes by absolute differences.

How far a box is off, seen along its own axes, is taken as drawn from a Laplace distribution, whose width is learned as
well: what cannot be known (the far side of a van seen from behind) is said with a larger deviation. That part of the
loss teaches the deviations alone and leaves the box as it is.
"""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from labeler.lidar.pillars.decode import Outputs
from labeler.training.devices import on_device
from labeler.training.pillar_targets import PillarTargets

_SQRT2 = 2**0.5
_OFFSET, _HEIGHT, _SIZE, _AXIS, _HEADING, _CLASS, _STD, _QUALITY = 2.0, 0.5, 2.0, 1.0, 0.2, 0.3, 0.1, 1.0


@dataclass(frozen=True, eq=False)
class AskedOfCells:
    """The targets of N examples on a device: ``heat`` (N, cells) float32 and ``counts`` (N, cells) bool, and for the
    K cells that learn a box, counted through all examples, ``cell``, ``weight``, ``box`` (K, 7) and ``classes``. There
    are ``objects`` vehicles. See :class:`labeler.training.pillar_targets.PillarTargets`."""

    heat: Tensor
    counts: Tensor
    cell: Tensor
    weight: Tensor
    box: Tensor
    classes: Tensor
    objects: int

    @staticmethod
    def of(targets: Sequence[PillarTargets], device: torch.device) -> AskedOfCells:
        """Those of several examples of one size, together."""
        cells = targets[0].heat.size
        return AskedOfCells(
            on_device(np.stack([target.heat.ravel() for target in targets]), device),
            on_device(np.stack([target.counts.ravel() for target in targets]), device),
            on_device(np.concatenate([target.cell + number * cells for number, target in enumerate(targets)]), device),
            on_device(np.concatenate([target.weight for target in targets]), device),
            on_device(np.concatenate([target.box for target in targets]), device),
            on_device(np.concatenate([target.classes for target in targets]), device),
            sum(target.objects for target in targets),
        )


def pillar_loss(output: Tensor, asked: AskedOfCells) -> Tensor:
    """Of (N, C, rows, columns) output against what is asked for: a sum of parts, each a mean over vehicles."""
    flat = output.permute(0, 2, 3, 1).reshape(-1, output.shape[1])
    total = _focal(flat[:, Outputs.HEAT].reshape(asked.heat.shape), asked.heat, asked.counts) / max(1, asked.objects)
    if not len(asked.cell):
        return total
    each = _box_loss(flat[asked.cell], asked.box, asked.classes)
    return total + (asked.weight * each).sum() / asked.weight.sum()


def _focal(logits: Tensor, heat: Tensor, counts: Tensor) -> Tensor:
    """CornerNet's (arXiv:1808.01244): cells around a middle are forgiven the more, the closer they are."""
    chance = logits.sigmoid().clamp(1e-4, 1 - 1e-4)
    is_middle = heat >= 1
    found = torch.where(is_middle, (1 - chance).square() * chance.log(), torch.zeros_like(chance))
    false = torch.where(is_middle, torch.zeros_like(chance), (1 - heat).pow(4) * chance.square() * (1 - chance).log())
    return -(found + false * counts).sum()


def _box_loss(said: Tensor, box: Tensor, classes: Tensor) -> Tensor:
    """(K,) for each cell that learns a box."""
    offset, yaw = said[:, Outputs.OFFSET], box[:, 6]
    log_size = box[:, 3:6].log()
    axis = torch.stack([(2 * yaw).sin(), (2 * yaw).cos()], dim=1)
    heading = torch.stack([yaw.sin(), yaw.cos()], dim=1)
    loss = _OFFSET * functional.smooth_l1_loss(offset, box[:, :2], beta=0.2, reduction="none").sum(dim=1)
    loss = loss + _HEIGHT * (said[:, Outputs.HEIGHT] - box[:, 2]).abs()
    loss = loss + _SIZE * (said[:, Outputs.LOG_SIZE] - log_size).abs().sum(dim=1)
    loss = loss + _AXIS * (said[:, Outputs.AXIS] - axis).abs().sum(dim=1)
    loss = loss + _HEADING * (said[:, Outputs.HEADING] - heading).square().sum(dim=1)
    loss = loss + _CLASS * functional.cross_entropy(said[:, Outputs.CLASSES :], classes, reduction="none")
    off, overlap = _off_and_overlap(said.detach(), box)
    log_std = said[:, Outputs.LOG_STD].clamp(-5, 3)
    loss = loss + _STD * (log_std + _SQRT2 * off / log_std.exp()).sum(dim=1)
    return loss + _QUALITY * functional.binary_cross_entropy_with_logits(
        said[:, Outputs.QUALITY], overlap, reduction="none"
    )


def _off_and_overlap(said: Tensor, box: Tensor) -> tuple[Tensor, Tensor]:
    """(K, 3) how far each box is off along its truth's length, across it, and in yaw, and (K,) about what its
    bird's-eye IoU is: that of boxes with the truth's yaw, less for a yaw that is off."""
    off_m, yaw = said[:, Outputs.OFFSET] - box[:, :2], box[:, 6]
    along = (yaw.cos() * off_m[:, 0] + yaw.sin() * off_m[:, 1]).abs()
    across = (yaw.cos() * off_m[:, 1] - yaw.sin() * off_m[:, 0]).abs()
    turned = torch.atan2(said[:, Outputs.AXIS.start], said[:, Outputs.AXIS.start + 1]) - 2 * yaw
    turned = torch.atan2(turned.sin(), turned.cos()).abs() / 2
    size = said[:, Outputs.LOG_SIZE].clamp(-1, 3.5).exp()
    shared = torch.ones_like(along)
    for off, side, true_side in ((along, size[:, 0], box[:, 3]), (across, size[:, 1], box[:, 4])):
        shared = shared * torch.minimum(torch.minimum(side, true_side), ((side + true_side) / 2 - off).clamp(min=0))
    union = size[:, 0] * size[:, 1] + box[:, 3] * box[:, 4] - shared
    overlap = (shared / union) * (1 - turned.sin().clamp(0, 1))
    return torch.stack([along, across, turned], dim=1), overlap.clamp(0, 1)
