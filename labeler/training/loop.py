"""The training loop that all models share: examples, gradients, averaged weights, checkpoints.

Each step's examples follow from the seed and the step alone, so a run that was stopped goes on as if it had not been.
Workers share them out; who computes the gradients, :mod:`labeler.training.gradients` says.

The learning rate warms up, stays, and falls along a cosine to nothing over the last part of the steps; the weights that
are kept are a running average (EMA) of those that are learned.
"""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import torch
from torch import nn

from labeler.training.devices import CPU, begin_device
from labeler.training.errors import TrainingError
from labeler.training.gradients import Gradients, gradients_by_workers, gradients_on_device
from labeler.training.state import CHECKPOINT, TrainingState
from labeler.training.task import Task, TrainingConfig, examples_of
from labeler.training.workers import open_workers

_REPORT_EVERY = 25


@dataclass(frozen=True, eq=False)
class Trained:
    """What came of it: the ``network`` with averaged weights, in evaluation mode, on the CPU; and which drives, and
    which device, were there from which step on."""

    network: nn.Module
    drives_since: tuple[tuple[int, tuple[str, ...]], ...]
    devices_since: tuple[tuple[int, str], ...] = ((0, "cpu"),)


def train(
    task: Task[Any, Any],
    config: TrainingConfig,
    folder: Path,
    *,
    report: Callable[[str], None],
    device: torch.device = CPU,
    by_workers: bool | None = None,
    stop_after: int | None = None,
) -> Trained:
    """Train, or go on where a checkpoint in ``folder`` stands. ``report`` hears a line every now and then; after
    ``stop_after`` steps of this call a checkpoint is written and the state so far returned. ``by_workers`` says whether
    the workers compute the gradients, or make examples for this process, which computes them on ``device``; if None
    they compute them on the CPU.

    TrainingError when the loss is not finite, when the device can't be used or has too little memory, when the
    checkpoint can't be read or is of other settings, or when ``folder`` can't be written."""
    torch.set_num_threads(1)
    by_workers = device == CPU if by_workers is None else by_workers
    with ExitStack() as stack:
        # Forked before a GPU is begun: what it has in a process does not survive a fork.
        make = partial(examples_of, task, config)
        makers = None if by_workers else stack.enter_context(open_workers(config.workers, make))
        begin_device(device)
        state = _begun(task, config, folder, device, report)
        last = config.steps if stop_after is None else min(config.steps, state.step + stop_after)
        if makers is None:
            computing = gradients_by_workers(task, config, state.learned)
        else:
            computing = gradients_on_device(task, makers, state.learned, range(state.step, last))
        gradients = stack.enter_context(computing)
        try:
            _advance(state, last, gradients, folder / CHECKPOINT, report)
        except torch.OutOfMemoryError as error:
            raise TrainingError(
                f"The GPU has too little memory for a batch of {config.batch_size}. Use a smaller --batch-size, and "
                "another folder."
            ) from error
    return Trained(state.average.network.to(CPU), tuple(state.drives_since), tuple(state.devices_since))


def _begun(
    task: Task[Any, Any], config: TrainingConfig, folder: Path, device: torch.device, report: Callable[[str], None]
) -> TrainingState:
    """A new state, or that of the checkpoint in the folder."""
    state = TrainingState(task, config, device)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise TrainingError(f"{folder} can't be written: {error.strerror}.") from error
    if (folder / CHECKPOINT).exists():
        state.restore(folder / CHECKPOINT)
        report(f"going on from step {state.step}")
    if not state.drives_since or state.drives_since[-1][1] != tuple(task.drives):
        state.drives_since.append((state.step, tuple(task.drives)))
    if not state.devices_since or (state.devices_since[-1][1] != device.type and state.step < config.steps):
        state.devices_since.append((state.step, device.type))
    return state


def _advance(state: TrainingState, last: int, gradients: Gradients, file: Path, report: Callable[[str], None]) -> None:
    """Do the steps up to ``last``."""
    config = state.config
    begun_s, begun_step = time.monotonic(), state.step
    while state.step < last:
        state.learn(gradients(state.step))
        if state.step % config.checkpoint_every == 0 or state.step == last:
            state.save(file)
        if state.step % _REPORT_EVERY == 0 or state.step == last:
            loss = state.mean_loss()  # waits for a GPU
            done = (state.step - begun_step) / (time.monotonic() - begun_s)
            report(
                f"step {state.step}/{config.steps}  loss {loss:.3f}  rate {config.rate_at(state.step - 1):.2e}  "
                f"{done * config.batch_size:.1f} examples/s  {(last - state.step) / done / 60:.0f} min left"
            )
