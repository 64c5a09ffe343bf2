"""ONNX files made on the spot, for tests of what opens and runs them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import TensorProto, helper, numpy_helper


def save_model(
    path: Path,
    nodes: list[onnx.NodeProto],
    constants: dict[str, NDArray[np.generic]],
    *,
    input_shape: Sequence[int | str],
    output_shape: Sequence[int | str],
    metadata: dict[str, str] | None = None,
    input_type: int = TensorProto.FLOAT,
) -> Path:
    """Write a model of one input ``images`` and one output ``output``; ``constants`` are the nodes' other inputs."""
    graph = helper.make_graph(
        nodes,
        "tiny",
        [helper.make_tensor_value_info("images", input_type, list(input_shape))],
        [helper.make_tensor_value_info("output", TensorProto.FLOAT, list(output_shape))],
        [numpy_helper.from_array(np.asarray(value), name) for name, value in constants.items()],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 13)], ir_version=8)
    helper.set_model_props(model, metadata or {})
    onnx.save(model, str(path))
    return path


def write_segmentation_model(
    path: Path,
    *,
    stride: int = 8,
    batch: int | str = "batch",
    hw: Sequence[int | str] = ("height", "width"),
    logits: bool = False,
    channel: int = 0,
    metadata: dict[str, str] | None = None,
) -> Path:
    """A segmentation of two classes: the second is as sure as a cell's mean of one input channel is near 255, the first
    is what the second is not. With ``logits`` the same as logarithms, less a constant."""
    weight = np.zeros((1, 3, stride, stride), np.float32)
    weight[0, channel] = 1 / (255 * stride**2)
    nodes = [
        helper.make_node("Conv", ["images", "weight"], ["second"], strides=[stride, stride]),
        helper.make_node("Sub", ["one", "second"], ["first"]),
        helper.make_node("Concat", ["first", "second"], ["shares" if logits else "output"], axis=1),
    ]
    if logits:
        nodes += [
            helper.make_node("Max", ["shares", "tiny"], ["positive"]),
            helper.make_node("Log", ["positive"], ["log"]),
            helper.make_node("Sub", ["log", "one"], ["output"]),
        ]
    return save_model(
        path,
        nodes,
        {"weight": weight, "one": np.array(1, np.float32), "tiny": np.array(1e-9, np.float32)},
        input_shape=(batch, 3, *hw),
        output_shape=(batch, 2, "rows", "columns"),
        metadata=metadata,
    )
