"""Writes trained networks as ONNX files, weights stored in half precision.

The detector's file has the form of YOLOX's own exports (raw grid, probabilities), so that the detection room runs it
like any other; the segmentation's that of the segmentation room (RGB in, probabilities a cell out), both with free
batch, height and width; the pillar network's that of the LiDAR room (the pillars of a direction in, a map of its cells
out). The weights are cast to single precision when a file is opened, so half precision halves the file and costs no
time.
"""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

import importlib
import json
import warnings
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from labeler.lidar.pillars.direction import PAINTED_CLASSES, columns_for
from labeler.lidar.pillars.grouping import DIRECTION_GRID, POINTS_PER_PILLAR, Grid, features_of
from labeler.training.clouds import PILLAR_CLASSES
from labeler.training.errors import TrainingError
from labeler.training.pictures import DETECTOR_CLASSES, SEGMENTATION_CLASSES
from labeler.training.pillar_network import PillarNetwork
from labeler.training.segmentation_network import STRIDE_PX

_OPSET = 17
_PROBE_HW = (64, 96)
_LARGEST_KEPT_ZEROS = 65536
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


class _PillarExport(nn.Module):
    def __init__(self, network: PillarNetwork, grid: Grid) -> None:
        super().__init__()
        self.network, self.grid = network, grid

    def forward(self, points: Tensor, cells: Tensor) -> Tensor:
        output: Tensor = self.network(points, cells, self.grid)
        return output


def export_detector(network: nn.Module, file: Path, *, source: str) -> None:
    """Write a ``Yolox`` network. ``source`` says what it was trained on. TrainingError when ``file`` can't be
    written."""
    about = {"task": "detection", "classes": json.dumps(DETECTOR_CLASSES), "licence": "Apache-2.0", "source": source}
    free = {"images": {0: "batch", 2: "height", 3: "width"}, "output": {0: "batch", 1: "cells"}}
    _export(_YoloxExport(network).eval(), file, _images(), free, about)


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
    _export(_SegmentationExport(network).eval(), file, _images(), free, about)


def export_pillars(network: PillarNetwork, file: Path, *, source: str, grid: Grid = DIRECTION_GRID) -> None:
    """Write a ``PillarNetwork`` for one direction at a time on ``grid``. TrainingError when ``file`` can't be
    written."""
    painted = PAINTED_CLASSES if network.columns == columns_for(PAINTED_CLASSES) else ()
    about = {
        "task": "pillars",
        "classes": json.dumps(PILLAR_CLASSES),
        "painted": json.dumps(painted),
        "grid": json.dumps(asdict(grid)),
        "licence": "Apache-2.0",
        "source": source,
    }
    points = torch.rand(3, POINTS_PER_PILLAR, features_of(network.columns))
    inputs = {"points": points, "cells": torch.tensor([0, 5, 9])}
    free = {"points": {0: "pillars"}, "cells": {0: "pillars"}}
    _export(_PillarExport(network, grid).eval(), file, inputs, free, about)


def _images() -> dict[str, Tensor]:
    return {"images": torch.zeros(1, 3, *_PROBE_HW)}


def _export(
    network: nn.Module,
    file: Path,
    inputs: Mapping[str, Tensor],
    free: Mapping[str, Mapping[int, str]],
    about: Mapping[str, str],
) -> None:
    onnx = import_onnx()
    temporary = file.with_name(f".{file.name}.tmp")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        with warnings.catch_warnings():
            # The exporter that replaces this one needs a package more and writes a file that is no better.
            warnings.simplefilter("ignore", DeprecationWarning)
            torch.onnx.export(
                network,
                tuple(inputs.values()),
                str(temporary),
                dynamo=False,
                opset_version=_OPSET,
                input_names=list(inputs),
                output_names=["output"],
                dynamic_axes=free,
            )
        model = onnx.load(str(temporary))
        _without_zeros(onnx, model)
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


def _without_zeros(onnx: Any, model: Any) -> None:
    """Make tensors of nothing but zeros, as an empty grid is, when the model runs instead of storing them."""
    graph = model.graph
    for node in graph.node:
        if node.op_type != "Constant" or node.attribute[0].name != "value":
            continue
        values = onnx.numpy_helper.to_array(node.attribute[0].t)
        if values.size < _LARGEST_KEPT_ZEROS or values.dtype != np.float32 or values.any():
            continue
        shape = onnx.numpy_helper.from_array(np.array(values.shape, np.int64), f"{node.output[0]}.shape")
        graph.initializer.append(shape)
        node.CopyFrom(onnx.helper.make_node("ConstantOfShape", [shape.name], list(node.output)))


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
