"""Tiny ONNX models with YOLOX's interface, made on the spot, whose boxes can be worked out by hand."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import onnx
import pytest
from numpy.typing import NDArray
from onnx import helper

from tests.made_models import save_model

STRIDES_PX = (8, 16, 32)
LOG_4 = float(np.log(4))

ModelMaker = Callable[..., Path]


@pytest.fixture
def constant_model(tmp_path: Path) -> ModelMaker:
    """A model that answers ``rows`` (A, 5 + C), or (N, A, 5 + C), to whatever it sees."""

    def make(
        rows: NDArray[np.float32],
        *,
        hw: Sequence[int | str] = (64, 64),
        name: str = "constant.onnx",
        metadata: dict[str, str] | None = None,
    ) -> Path:
        output = rows if rows.ndim == 3 else rows[None]
        return save_model(
            tmp_path / name,
            [helper.make_node("Identity", ["rows"], ["output"])],
            {"rows": output.astype(np.float32)},
            input_shape=(len(output), 3, *hw),
            output_shape=output.shape,
            metadata=metadata,
        )

    return make


@pytest.fixture
def pixel_model(tmp_path: Path) -> ModelMaker:
    """A model that reads its boxes out of the image: each cell looks at its upper left pixel.

    Objectness is (blue - 128) / 127, the probability of class 0 (green - 128) / 127 and of class 1 (red - 128) / 127,
    all cut to 0..1, so the grey of the padding gives none. Every box is centred in its cell and has four cells' sides.
    With ``decoded`` it gives pixels, and ``hw`` must be fixed.
    """

    def make(
        *,
        batch: int | str = "batch",
        hw: Sequence[int | str] = ("height", "width"),
        decoded: bool = False,
        name: str = "pixel.onnx",
        metadata: dict[str, str] | None = None,
    ) -> Path:
        weight = np.zeros((7, 3, 1, 1), np.float32)
        for channel, colour in ((4, 0), (5, 1), (6, 2)):  # objectness, class 0, class 1 from blue, green, red
            weight[channel, colour] = 1 / 127
        bias = np.array([0.5, 0.5, LOG_4, LOG_4, *[-128 / 127] * 3], np.float32)
        constants: dict[str, NDArray[np.generic]] = {
            "weight": weight,
            "bias": bias,
            "low": np.array([-9, -9, -9, -9, 0, 0, 0], np.float32).reshape(1, 7, 1),
            "high": np.array([9, 9, 9, 9, 1, 1, 1], np.float32).reshape(1, 7, 1),
            "flat": np.array([0, 7, -1], np.int64),
        }
        nodes: list[onnx.NodeProto] = []
        for stride in STRIDES_PX:
            conv = helper.make_node(
                "Conv", ["images", "weight", "bias"], [f"map_{stride}"], strides=[stride, stride], kernel_shape=[1, 1]
            )
            nodes += [conv, helper.make_node("Reshape", [f"map_{stride}", "flat"], [f"cells_{stride}"])]
        nodes += [
            helper.make_node("Concat", [f"cells_{stride}" for stride in STRIDES_PX], ["all"], axis=2),
            helper.make_node("Max", ["all", "low"], ["at_least"]),
            helper.make_node("Min", ["at_least", "high"], ["clipped"]),
            helper.make_node("Transpose", ["clipped"], ["raw" if decoded else "output"], perm=[0, 2, 1]),
        ]
        if decoded:
            height, width = (int(side) for side in hw)
            constants["factor"], constants["offset"] = _decode_constants(height, width)
            nodes += [
                helper.make_node("Mul", ["raw", "factor"], ["scaled"]),
                helper.make_node("Add", ["scaled", "offset"], ["output"]),
            ]
        return save_model(
            tmp_path / name,
            nodes,
            constants,
            input_shape=(batch, 3, *hw),
            output_shape=(batch, "anchors", 7),
            metadata=metadata,
        )

    return make


def _decode_constants(height: int, width: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    factors: list[list[float]] = []
    offsets: list[list[float]] = []
    for stride in STRIDES_PX:
        for row in range(height // stride):
            for column in range(width // stride):
                factors.append([stride, stride, 4 * stride / LOG_4, 4 * stride / LOG_4, 1, 1, 1])
                offsets.append([column * stride, row * stride, 0, 0, 0, 0, 0])
    return np.array(factors, np.float32), np.array(offsets, np.float32)
