"""What a training has come to: the network that learns, the average of its weights, and what a checkpoint keeps."""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

import copy
import math
from dataclasses import asdict
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn

from labeler.training.errors import TrainingError
from labeler.training.flat import FlatNetwork
from labeler.training.task import Task, TrainingConfig

CHECKPOINT = "checkpoint.pt"
_EMA_STEPS = 10
_GRADIENT_LIMIT = 10.0
_MAY_CHANGE = ("steps", "checkpoint_every")
"""Settings that a run may be gone on with changed: how long it shall be need not be known at its beginning."""


class TrainingState:
    """``learned`` is the network that learns and ``average`` the one that is kept, both on ``device``; ``step`` counts
    the steps done. ``drives_since`` and ``devices_since`` say from which step on which drives and device were used."""

    def __init__(self, task: Task[Any, Any], config: TrainingConfig, device: torch.device) -> None:
        self.config, self.step = config, 0
        torch.manual_seed(config.seed)
        network = task.new_network().to(device)
        self.average = FlatNetwork(copy.deepcopy(network).eval().requires_grad_(False))
        self.learned = FlatNetwork(network)
        self._optimizer = torch.optim.AdamW(
            [
                {"params": [_as_parameter(self.learned.weights, self.learned.weights_grad)]},
                {"params": [_as_parameter(self.learned.offsets, self.learned.offsets_grad)], "weight_decay": 0.0},
            ],
            lr=config.learning_rate,
            weight_decay=config.weight_decay,
        )
        self.drives_since: list[tuple[int, tuple[str, ...]]] = []
        self.devices_since: list[tuple[int, str]] = []
        self._unread: list[Tensor] = []
        self._losses: list[float] = []

    @torch.no_grad()
    def learn(self, loss: Tensor) -> None:
        """Take a step along the gradients that are in the learned network. ``loss`` is read when it has to be: reading
        it waits until a GPU has computed it."""
        self._unread.append(loss)
        for group in self._optimizer.param_groups:
            group["lr"] = self.config.rate_at(self.step)
        length = torch.stack([grad.square().sum() for grad in self.learned.grads]).double().sum().sqrt()
        shorter = (_GRADIENT_LIMIT / length).clamp(max=1.0).float()
        for grad in self.learned.grads:
            grad.mul_(shorter)
        self._optimizer.step()
        keep = min(self.config.ema_decay, (1 + self.step) / (_EMA_STEPS + self.step))
        for average, new in zip(self.average.rows, self.learned.rows, strict=True):
            average.lerp_(new, 1 - keep)
        self.step += 1

    def mean_loss(self) -> float:
        """Of the steps since this was last asked. TrainingError when a loss is not finite."""
        self._read_losses()
        mean = sum(self._losses) / max(len(self._losses), 1)
        self._losses.clear()
        return mean

    def _read_losses(self) -> None:
        losses = [float(loss) for loss in torch.stack(self._unread).cpu()] if self._unread else []
        for step, loss in enumerate(losses, self.step - len(losses)):
            if not math.isfinite(loss):
                raise TrainingError(f"The loss of step {step} is {loss}. Begin again, with another seed.")
        self._losses += losses
        self._unread.clear()

    def save(self, file: Path) -> None:
        """TrainingError when a number is not finite, or ``file`` can't be written: the last checkpoint is kept."""
        self._read_losses()
        if not all(bool(row.isfinite().all()) for row in self.learned.rows):
            raise TrainingError(f"Weights after step {self.step} are not finite. Begin again, with another seed.")
        state = {
            "config": asdict(self.config),
            "step": self.step,
            "network": self.learned.network.state_dict(),
            "average": self.average.network.state_dict(),
            "optimizer": self._optimizer.state_dict(),
            "drives_since": self.drives_since,
            "devices_since": self.devices_since,
        }
        temporary = file.with_name(f".{file.name}.tmp")
        try:
            torch.save(state, temporary)
            temporary.replace(file)
        except (OSError, RuntimeError) as error:
            temporary.unlink(missing_ok=True)
            raise TrainingError(f"{file} can't be written: {error}. The last checkpoint is kept.") from error

    def restore(self, file: Path) -> None:
        """Go on from a checkpoint, of whichever device. TrainingError when it can't be read or is of other settings."""
        try:
            state = _read(file)
            before, now = state["config"], asdict(self.config)
            changed = sorted(name for name in now if now[name] != before.get(name) and name not in _MAY_CHANGE)
            if changed:
                was = ", ".join(f"{name} {before.get(name)}, now {now[name]}" for name in changed)
                raise TrainingError(f"{file} was trained with other settings ({was}). Use them, or another folder.")
            self.learned.network.load_state_dict(state["network"])
            self.average.network.load_state_dict(state["average"])
            self._optimizer.load_state_dict(state["optimizer"])
            self.step = int(state["step"])
            self.drives_since = [(int(step), tuple(drives)) for step, drives in state["drives_since"]]
            # Checkpoints of earlier versions, which knew the CPU alone, don't say it.
            self.devices_since = [(int(step), str(name)) for step, name in state.get("devices_since", [(0, "cpu")])]
        except TrainingError:
            raise
        except Exception as error:  # a damaged file fails in many ways
            raise TrainingError(f"{file} can't be gone on from: {error}. Delete it to begin again.") from error


def kept_workers(folder: Path) -> int | None:
    """How many workers a checkpoint in ``folder`` was trained by; None where there is none that can be read."""
    try:
        return int(_read(folder / CHECKPOINT)["config"]["workers"])
    except Exception:  # a damaged file fails in many ways, and is told of when it is gone on from
        return None


def _read(file: Path) -> dict[str, Any]:
    return torch.load(file, map_location="cpu", weights_only=True)


def _as_parameter(row: Tensor, grad: Tensor) -> nn.Parameter:
    parameter = nn.Parameter(row)
    parameter.grad = grad
    return parameter
