"""The processor that computes gradients: the CPU, or a GPU."""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

import os
from contextlib import AbstractContextManager, nullcontext

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from labeler.training.errors import TrainingError
from labeler.training.recipes import Device

CPU = torch.device("cpu")
_MOST_WORKERS = 16


def device_of(device: Device) -> torch.device:
    """TrainingError when torch can't use it.

    CUDA is not begun by asking: processes that are forked afterwards may still be."""
    if device is Device.CPU:
        return CPU
    if torch.cuda.device_count() < 1:
        raise TrainingError(
            "--device cuda needs an NVIDIA GPU that torch can use, and it finds none (torch "
            f"{torch.__version__}). Leave it out to train on the CPU."
        )
    return torch.device(device)


def begin_device(device: torch.device) -> None:
    """Begin to use a device. TrainingError when that fails. To be called after processes were forked."""
    if device.type != "cuda":
        return
    try:
        torch.zeros(1, device=device)
    except RuntimeError as error:
        raise TrainingError(
            f"--device cuda needs an NVIDIA GPU that torch can use: {error}. Leave it out to train on the CPU."
        ) from error
    torch.backends.cudnn.benchmark = True  # examples come in a few sizes: the fastest convolution for each is kept


def workers_for(batch_size: int) -> int:
    """How many processes make examples for a GPU: what the cores allow, one kept free, that share a batch evenly."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    most = max(1, min(cores - 1, _MOST_WORKERS, batch_size))
    return max(count for count in range(1, most + 1) if batch_size % count == 0)


def on_device(array: NDArray[np.generic], device: torch.device) -> Tensor:
    """A writable array as a tensor on a device; nobody waits until it has arrived."""
    tensor = torch.from_numpy(array)
    if device.type == "cuda":
        tensor = tensor.pin_memory()
    return tensor.to(device, non_blocking=True)


def half_precision(device: torch.device) -> AbstractContextManager[object]:
    """Inside of it a network on a GPU computes in bfloat16 where that does little harm; elsewhere as always."""
    return torch.autocast("cuda", torch.bfloat16) if device.type == "cuda" else nullcontext()


def full_precision(device: torch.device) -> AbstractContextManager[object]:
    """Inside of it a part of such a network computes as always."""
    return torch.autocast("cuda", enabled=False) if device.type == "cuda" else nullcontext()
