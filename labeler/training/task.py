"""What is learned, and by which settings."""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import numpy as np
import torch
from torch import Tensor, nn

from labeler.training.errors import TrainingError

Example = TypeVar("Example")
Batch = TypeVar("Batch")


@dataclass(frozen=True)
class TrainingConfig:
    """``steps`` of ``batch_size`` examples in all, drawn from ``seed``. The learning rate reaches ``learning_rate``
    after ``warm_up_steps`` and falls over the last ``fall_share`` of all steps. ``workers`` processes share a step's
    examples."""

    seed: int
    steps: int
    batch_size: int = 8
    workers: int = 2
    learning_rate: float = 2e-3
    weight_decay: float = 0.02
    warm_up_steps: int = 100
    fall_share: float = 0.4
    ema_decay: float = 0.998
    checkpoint_every: int = 100

    def __post_init__(self) -> None:
        if self.steps < 1 or self.workers < 1 or self.batch_size < self.workers or self.batch_size % self.workers:
            raise TrainingError(
                f"Training needs at least one step, and a batch that its workers can share evenly; got {self.steps} "
                f"steps, a batch of {self.batch_size} and {self.workers} workers."
            )

    def rate_at(self, step: int) -> float:
        """The learning rate of a step, counted from 0."""
        warm = min(1.0, (step + 1) / max(self.warm_up_steps, 1))
        falling = max(1.0, self.fall_share * self.steps)
        into_fall = max(0.0, step + falling - self.steps) / falling
        return self.learning_rate * warm * (1 + math.cos(math.pi * into_fall)) / 2


class Task(Protocol[Example, Batch]):
    """What is learned."""

    @property
    def drives(self) -> Sequence[str]:
        """Names of the drives that examples come from."""
        ...

    def new_network(self) -> nn.Module:
        """An untrained network, from torch's random state."""
        ...

    def examples(self, rng: np.random.Generator, numbers: range) -> Sequence[Example]:
        """A step's examples of these ``numbers``, of those from 0 to the batch's size. Called by several workers at
        once: numpy alone, and what can be sent from one process to another."""
        ...

    def batch(self, examples: Sequence[Example], device: torch.device) -> Batch:
        """The examples put together, on a device. Called in a thread while another batch is learned from."""
        ...

    def loss(self, network: nn.Module, batch: Batch) -> Tensor:
        """The mean loss on a batch, on its device, where the network has to be. Nothing in it may wait for a value that
        the device computes."""
        ...


def examples_of(task: Task[Example, Any], config: TrainingConfig, worker: int, step: int) -> Sequence[Example]:
    """A worker's share of a step's examples. They follow from these numbers alone."""
    share = config.batch_size // config.workers
    rng = np.random.default_rng([config.seed, step, worker])
    return task.examples(rng, range(worker * share, (worker + 1) * share))
