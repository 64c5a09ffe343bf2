"""The training loop that both models share: examples, gradients, averaged weights, checkpoints.

Each step's examples follow from the seed and the step alone, so a run that was stopped goes on as if it had not been. A
step's examples are shared out among workers, each with its own copy of the network on one core; gradients and the
statistics of batch normalisation are averaged. (On a busy machine that is twice as quick as threads inside each
convolution, which wait for each other hundreds of times a step.)

The learning rate warms up, stays, and falls along a cosine to nothing over the last part of the steps; the weights that
are kept are a running average (EMA) of those that are learned.
"""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

import copy
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import torch
from torch import Tensor, nn

from labeler.training.errors import TrainingError
from labeler.training.flat import FlatNetwork
from labeler.training.workers import open_workers

CHECKPOINT = "checkpoint.pt"
_EMA_STEPS = 10
_GRADIENT_LIMIT = 10.0
_REPORT_EVERY = 25


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


class Task(Protocol):
    """What is learned."""

    @property
    def drives(self) -> Sequence[str]:
        """Names of the drives that examples come from."""
        ...

    def new_network(self) -> nn.Module:
        """An untrained network, from torch's random state."""
        ...

    def loss(self, network: nn.Module, rng: np.random.Generator, count: int) -> Tensor:
        """The mean loss on ``count`` examples. Called by several workers at once, each with its own network."""
        ...


@dataclass(frozen=True, eq=False)
class Trained:
    """What came of it: the ``network`` with averaged weights, in evaluation mode, and which drives were there from
    which step on."""

    network: nn.Module
    drives_since: tuple[tuple[int, tuple[str, ...]], ...]


class _Run:
    """The state of a training: all that a checkpoint holds."""

    def __init__(self, task: Task, config: TrainingConfig) -> None:
        self.task, self.config, self.step = task, config, 0
        torch.manual_seed(config.seed)
        network = task.new_network()
        self.average = FlatNetwork(copy.deepcopy(network).eval().requires_grad_(False))
        self.copies = [FlatNetwork(copy.deepcopy(network).train()) for _ in range(config.workers)]
        self.learned = FlatNetwork(network)
        self.optimizer = torch.optim.AdamW(
            [
                {"params": [_as_parameter(self.learned.weights, self.learned.weights_grad)]},
                {"params": [_as_parameter(self.learned.offsets, self.learned.offsets_grad)], "weight_decay": 0.0},
            ],
            lr=config.learning_rate,
            weight_decay=config.weight_decay,
        )
        self.drives_since: list[tuple[int, tuple[str, ...]]] = []

    def work(self, worker: int, step: int) -> float:
        """In a worker: the gradients of its share of a step's examples into its copy, and their loss."""
        config, copied = self.config, self.copies[worker]
        rng = np.random.default_rng([config.seed, step, worker])
        copied.clear_grads()
        loss = self.task.loss(copied.network, rng, config.batch_size // config.workers)
        loss.backward()
        return float(loss.detach())

    def advance(self, work_all: Callable[[int], Sequence[float]]) -> float:
        """Do one step; the mean loss before it."""
        config = self.config
        losses = work_all(self.step)
        mean = sum(losses) / len(losses)
        if not math.isfinite(mean):
            raise TrainingError(f"The loss of step {self.step} is {mean}. Begin again, with another seed.")
        for group in self.optimizer.param_groups:
            group["lr"] = config.rate_at(self.step)
        with torch.no_grad():
            self._gather()
            self.optimizer.step()
            self._spread()
        self.step += 1
        return mean

    def _gather(self) -> None:
        """Mean gradients, limited in length, and mean statistics of the copies, into the learned network."""
        for own, *others in zip(self.learned.grads, *(c.grads for c in self.copies), strict=True):
            torch.mean(torch.stack(others), dim=0, out=own)
        torch.mean(torch.stack([c.statistics for c in self.copies]), dim=0, out=self.learned.statistics)
        length = math.sqrt(sum(float(grad.square().sum()) for grad in self.learned.grads))
        if length > _GRADIENT_LIMIT:
            for grad in self.learned.grads:
                grad.mul_(_GRADIENT_LIMIT / length)

    def _spread(self) -> None:
        """The learned network's new state, into the copies and the running average."""
        keep = min(self.config.ema_decay, (1 + self.step) / (_EMA_STEPS + self.step))
        for average, new in zip(self.average.rows, self.learned.rows, strict=True):
            average.lerp_(new, 1 - keep)
        for copied in self.copies:
            copied.copy_from(self.learned)

    def save(self, file: Path) -> None:
        state = {
            "config": asdict(self.config),
            "step": self.step,
            "network": self.learned.network.state_dict(),
            "average": self.average.network.state_dict(),
            "optimizer": self.optimizer.state_dict(),
            "drives_since": self.drives_since,
        }
        temporary = file.with_name(f".{file.name}.tmp")
        try:
            torch.save(state, temporary)
            temporary.replace(file)
        except (OSError, RuntimeError) as error:
            temporary.unlink(missing_ok=True)
            raise TrainingError(f"{file} can't be written: {error}. The last checkpoint is kept.") from error

    def restore(self, file: Path) -> None:
        try:
            state: dict[str, Any] = torch.load(file, weights_only=True)
            before, now = state["config"], asdict(self.config)
            changed = sorted(name for name in now if now[name] != before.get(name) and name not in _MAY_CHANGE)
            if changed:
                was = ", ".join(f"{name} {before.get(name)}, now {now[name]}" for name in changed)
                raise TrainingError(f"{file} was trained with other settings ({was}). Use them, or another folder.")
            self.learned.network.load_state_dict(state["network"])
            self.average.network.load_state_dict(state["average"])
            self.optimizer.load_state_dict(state["optimizer"])
            self.step = int(state["step"])
            self.drives_since = [(int(step), tuple(drives)) for step, drives in state["drives_since"]]
            for copied in self.copies:
                copied.copy_from(self.learned)
        except TrainingError:
            raise
        except Exception as error:  # a damaged file fails in many ways
            raise TrainingError(f"{file} can't be gone on from: {error}. Delete it to begin again.") from error


_MAY_CHANGE = ("steps", "checkpoint_every")
"""Settings that a run may be gone on with changed: how long it shall be need not be known at its beginning."""


def train(
    task: Task,
    config: TrainingConfig,
    folder: Path,
    *,
    report: Callable[[str], None],
    stop_after: int | None = None,
) -> Trained:
    """Train, or go on where a checkpoint in ``folder`` stands. ``report`` hears a line every now and then; after
    ``stop_after`` steps of this call a checkpoint is written and the state so far returned.

    TrainingError when the loss is not finite, when the checkpoint can't be read or is of other settings, or when
    ``folder`` can't be written."""
    torch.set_num_threads(1)
    run = _Run(task, config)
    file = folder / CHECKPOINT
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise TrainingError(f"{folder} can't be written: {error.strerror}.") from error
    if file.exists():
        run.restore(file)
        report(f"going on from step {run.step}")
    if not run.drives_since or run.drives_since[-1][1] != tuple(task.drives):
        run.drives_since.append((run.step, tuple(task.drives)))
    last = config.steps if stop_after is None else min(config.steps, run.step + stop_after)
    for copied in run.copies:
        copied.share()
    with open_workers(config.workers, run.work) as work_all:
        begun_s, begun_step, losses = time.monotonic(), run.step, list[float]()
        while run.step < last:
            losses.append(run.advance(work_all))
            if run.step % config.checkpoint_every == 0 or run.step == last:
                run.save(file)
            if run.step % _REPORT_EVERY == 0 or run.step == last:
                done = (run.step - begun_step) / (time.monotonic() - begun_s)
                report(
                    f"step {run.step}/{config.steps}  loss {sum(losses) / len(losses):.3f}  rate "
                    f"{config.rate_at(run.step - 1):.2e}  {done * config.batch_size:.1f} examples/s  "
                    f"{(last - run.step) / done / 60:.0f} min left"
                )
                losses.clear()
    return Trained(run.average.network, tuple(run.drives_since))


def _as_parameter(row: Tensor, grad: Tensor) -> nn.Parameter:
    parameter = nn.Parameter(row)
    parameter.grad = grad
    return parameter
