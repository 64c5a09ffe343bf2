"""A network's numbers in a few long rows, so that a step handles them in a few operations instead of thousands.

A small network has hundreds of small tensors. Averaging gradients, the optimiser's step, running averages and copies
cost more time tensor by tensor than all of the convolutions. Here each tensor becomes a view into one of three rows.
"""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor, nn


class FlatNetwork:
    """A network whose numbers lie in rows: ``weights`` (those of convolutions), ``offsets`` (biases and normalisations)
    and ``statistics`` (running means and variances), with ``weights_grad`` and ``offsets_grad`` beside the first
    two."""

    def __init__(self, network: nn.Module) -> None:
        self.network = network
        parameters = list(network.parameters())
        matrices = [p for p in parameters if p.ndim > 1]
        vectors = [p for p in parameters if p.ndim <= 1]
        self.weights, self.offsets = _into_row(matrices), _into_row(vectors)
        self.weights_grad, self.offsets_grad = torch.zeros_like(self.weights), torch.zeros_like(self.offsets)
        self.statistics = _into_row([b for b in network.buffers() if b.is_floating_point()])
        for tensors, row in ((matrices, self.weights_grad), (vectors, self.offsets_grad)):
            for tensor, part in zip(tensors, _parts(tensors, row), strict=True):
                tensor.grad = part

    @property
    def rows(self) -> tuple[Tensor, Tensor, Tensor]:
        return self.weights, self.offsets, self.statistics

    @property
    def grads(self) -> tuple[Tensor, Tensor]:
        return self.weights_grad, self.offsets_grad

    def share(self) -> None:
        """Move the numbers into memory that processes which are forked from now on share with this one."""
        for row in (*self.rows, *self.grads):
            row.share_memory_()

    def clear_grads(self) -> None:
        for row in self.grads:
            row.zero_()

    def copy_from(self, other: FlatNetwork) -> None:
        for own, new in zip(self.rows, other.rows, strict=True):
            own.copy_(new)


def _into_row(tensors: Sequence[Tensor]) -> Tensor:
    """A row with the numbers of all tensors, of which they become views."""
    with torch.no_grad():
        row = torch.cat([tensor.reshape(-1) for tensor in tensors]) if tensors else torch.zeros(0)
        for tensor, part in zip(tensors, _parts(tensors, row), strict=True):
            tensor.data = part
    return row


def _parts(tensors: Sequence[Tensor], row: Tensor) -> list[Tensor]:
    parts: list[Tensor] = []
    start = 0
    for tensor in tensors:
        stop = start + tensor.numel()
        parts.append(row[start:stop].view(tensor.shape))
        start = stop
    return parts
