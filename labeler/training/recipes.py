"""How the shipped models were trained: what is not an option of the commands."""

from __future__ import annotations

from dataclasses import dataclass

from labeler.training.crops import CropConfig


@dataclass(frozen=True)
class Recipe:
    """A model by ``task``: its file's name, the examples it learns from, for how many ``steps``, at which rate, and
    among how many ``workers`` its steps' examples are shared."""

    task: str
    file_name: str
    crops: CropConfig
    steps: int
    learning_rate: float
    workers: int


DETECTOR = Recipe(
    task="detector",
    file_name="sim-yolox-nano.onnx",
    crops=CropConfig(height_px=160, width_px=320),
    steps=5000,
    learning_rate=2e-3,
    workers=2,
)
SEGMENTATION = Recipe(
    task="segmentation",
    file_name="sim-segmentation.onnx",
    crops=CropConfig(height_px=192, width_px=384, replicate_edge=True),
    steps=2400,
    learning_rate=4e-3,
    workers=1,
)
