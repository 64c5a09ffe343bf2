"""Two ways to compute a step's gradients: each worker those of its share on a core of its own, or all on a GPU.

On the CPU each worker has its own copy of the network; gradients and the statistics of batch normalisation are
averaged. On a busy machine that is twice as quick as threads inside each convolution, which wait for each other
hundreds of times a step. A GPU takes the whole batch at once, and the workers make the examples of the next steps
meanwhile.
"""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

import copy
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from typing import Any

import torch
from torch import Tensor

from labeler.training.devices import CPU
from labeler.training.flat import FlatNetwork
from labeler.training.task import Task, TrainingConfig, examples_of
from labeler.training.workers import Workers, answers_ahead, open_workers

Gradients = Callable[[int], Tensor]
"""Puts the gradients of a step's examples, and the statistics of batch normalisation, into the network that learns.
Takes the steps in turn; the answer is their mean loss, a scalar on the network's device."""

_STEPS_AHEAD = 4


@contextmanager
def gradients_by_workers(task: Task[Any, Any], config: TrainingConfig, learned: FlatNetwork) -> Generator[Gradients]:
    """Worker processes that compute the gradients."""
    copies = [FlatNetwork(copy.deepcopy(learned.network).train()) for _ in range(config.workers)]
    for copied in copies:
        copied.share()

    def work(worker: int, step: int) -> float:
        copies[worker].clear_grads()
        batch = task.batch(examples_of(task, config, worker, step), CPU)
        loss = task.loss(copies[worker].network, batch)
        loss.backward()
        return float(loss.detach())

    with open_workers(config.workers, work) as workers:

        def compute(step: int) -> Tensor:
            for copied in copies:
                copied.copy_from(learned)
            workers.ask(step)
            losses = workers.answers()
            for own, *others in zip(learned.grads, *(copied.grads for copied in copies), strict=True):
                torch.mean(torch.stack(others), dim=0, out=own)
            torch.mean(torch.stack([copied.statistics for copied in copies]), dim=0, out=learned.statistics)
            return torch.tensor(sum(losses) / len(losses))

        yield compute


@contextmanager
def gradients_on_device(
    task: Task[Any, Any], makers: Workers[Sequence[Any]], learned: FlatNetwork, steps: range
) -> Generator[Gradients]:
    """This process computes the gradients of ``steps`` on the network's device; ``makers`` make the examples."""
    device = learned.weights.device
    network = learned.network.train()

    def batch_of(shares: Sequence[Sequence[Any]]) -> Any:
        return task.batch([example for share in shares for example in share], device)

    with answers_ahead(makers, steps, _STEPS_AHEAD, batch_of) as batches:

        def compute(step: int) -> Tensor:
            del step  # they come in turn
            learned.clear_grads()
            loss = task.loss(network, next(batches))
            loss.backward()
            return loss.detach()

        yield compute
