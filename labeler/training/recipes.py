"""How the shipped models were trained: what is not an option of the commands."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum

from labeler.training.crops import CropConfig


class Device(StrEnum):
    """What computes the gradients."""

    CPU = "cpu"
    CUDA = "cuda"


@dataclass(frozen=True)
class Recipe:
    """A model by ``task``: its file's name, the examples it learns from, for how many ``steps``, at which rate, and
    among how many ``workers`` its steps' examples are shared on the CPU. The examples are dealt out to ``crops`` in
    turn; there are none where windows of clouds are the examples."""

    task: str
    file_name: str
    crops: tuple[CropConfig, ...]
    steps: int
    learning_rate: float
    workers: int


_WINDOW = CropConfig(height_px=160, width_px=320, around_objects=0.6)
_WHOLE = CropConfig(height_px=320, width_px=640, smallest_scale=0.6, largest_scale=1.1)
"""Nearly a whole image, as large as it will be: only there near vehicles are seen at their full size."""

DETECTOR = Recipe(
    task="detector",
    file_name="sim-yolox-nano.onnx",
    crops=(_WINDOW, _WINDOW, _WINDOW, _WHOLE),
    steps=7000,
    learning_rate=2e-3,
    workers=2,
)
SEGMENTATION = Recipe(
    task="segmentation",
    file_name="sim-segmentation.onnx",
    crops=(CropConfig(height_px=192, width_px=384, replicate_edge=True),),
    steps=2400,
    learning_rate=4e-3,
    workers=1,
)
PILLARS = Recipe(
    task="pillars",
    file_name="sim-pillars.onnx",
    crops=(),
    steps=8000,
    learning_rate=2e-3,
    workers=2,
)
UNPAINTED_PILLARS = replace(PILLARS, file_name="sim-pillars-unpainted.onnx")
"""The same without what images say, to show what painting is worth."""
