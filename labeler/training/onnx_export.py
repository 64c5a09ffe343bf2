"""Writes trained networks as ONNX files with free batch, height and width, weights stored in half precision.

The detector's file has the form of YOLOX's own exports (raw grid, probabilities), so that the detection room runs it
like any other; the segmentation's that of the segmentation room (RGB in, probabilities a cell out). The weights are
cast to single precision when a file is opened, so half precision halves the file and costs no time.
"""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

import importlib
import json
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from labeler.training.errors import TrainingError
from labeler.training.pictures import DETECTOR_CLASSES, SEGMENTATION_CLASSES
from labeler.training.segmentation_network import STRIDE_PX

_OPSET = 17
_PROBE_HW = (64, 96)
_SMALLEST_HALVED = 64
"""Tensors of fewer numbers (sizes, biases of a few classes) stay as they are."""


class _YoloxExport(nn.Module):
    def __init__(self, network: nn.Module) -> None:
        super().__init__()
        self.network = network

    def forward(self, images: Tensor) -> Tensor:
        cells: Tensor = self.network(images)
        return torch.cat([cells[..., :4], cells[..., 4:].sigmoid()], dim=2)


class _SegmentationExport(nn.Module):
    def __init__(self, network: nn.Module) -> None:
        super().__init__()
        self.network = network

    def forward(self, images: Tensor) -> Tensor:
        logits: Tensor = self.network(images)
        return logits.softmax(dim=1)


def export_detector(network: nn.Module, file: Path, *, source: str) -> None:
    """Write a ``Yolox`` network. ``source`` says what it was trained on. TrainingError when ``file`` can't be
    written."""
    about = {"task": "detection", "classes": json.dumps(DETECTOR_CLASSES), "licence": "Apache-2.0", "source": source}
    free = {"images": {0: "batch", 2: "height", 3: "width"}, "output": {0: "batch", 1: "cells"}}
    _export(_YoloxExport(network).eval(), file, free, about)


def export_segmentation(network: nn.Module, file: Path, *, source: str) -> None:
    """Write a ``SegmentationNetwork``. TrainingError when ``file`` can't be written."""
    about = {
        "task": "segmentation",
        "classes": json.dumps(SEGMENTATION_CLASSES),
        "stride": str(STRIDE_PX),
        "multiple": "32",
        "licence": "Apache-2.0",
        "source": source,
    }
    free = {
        "images": {0: "batch", 2: "height", 3: "width"},
        "output": {0: "batch", 2: "rows", 3: "columns"},
    }
    _export(_SegmentationExport(network).eval(), file, free, about)


def _export(network: nn.Module, file: Path, free: Mapping[str, Mapping[int, str]], about: Mapping[str, str]) -> None:
    onnx = import_onnx()
    temporary = file.with_name(f".{file.name}.tmp")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        with warnings.catch_warnings():
            # The exporter that replaces this one needs a package more and writes a file that is no better.
            warnings.simplefilter("ignore", DeprecationWarning)
            torch.onnx.export(
                network,
                (torch.zeros(1, 3, *_PROBE_HW),),
                str(temporary),
                dynamo=False,
                opset_version=_OPSET,
                input_names=["images"],
                output_names=["output"],
                dynamic_axes=free,
            )
        model = onnx.load(str(temporary))
        _halve(onnx, model)
        onnx.helper.set_model_props(model, dict(about))
        onnx.checker.check_model(model)
        onnx.save(model, str(temporary))
        temporary.replace(file)
    except OSError as error:
        raise TrainingError(f"{file} can't be written: {error}.") from error
    finally:
        temporary.unlink(missing_ok=True)


def import_onnx() -> Any:
    """The package onnx. TrainingError, which names the extra, when it is missing."""
    try:
        return importlib.import_module("onnx")
    except ImportError as error:
        raise TrainingError(
            f"onnx can't be loaded ({error}). Install it: pip install 'hindsight-labeler[training]'"
        ) from error


def _halve(onnx: Any, model: Any) -> None:
    """Store the weights in half precision, each behind a cast to single."""
    graph, casts = model.graph, list[Any]()
    for tensor in graph.initializer:
        values = onnx.numpy_helper.to_array(tensor)
        if values.dtype != np.float32 or values.size < _SMALLEST_HALVED:
            continue
        name = tensor.name
        tensor.CopyFrom(onnx.numpy_helper.from_array(values.astype(np.float16), f"{name}.half"))
        casts.append(onnx.helper.make_node("Cast", [f"{name}.half"], [name], to=onnx.TensorProto.FLOAT))
    nodes = [*casts, *graph.node]
    del graph.node[:]
    graph.node.extend(nodes)
