"""A pillar network's file, made by code, that finds the same boxes wherever there are any points at all."""

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

from labeler.lidar.pillars.decode import STRIDE, Outputs
from labeler.lidar.pillars.direction import PAINTED_CLASSES, columns_for
from labeler.lidar.pillars.grouping import POINTS_PER_PILLAR, Grid, features_of

GRID = Grid(x_min_m=0.0, y_min_m=-16.0, cell_m=0.5, rows=96, columns=64)
CLASSES = ("car", "truck", "bus", "motorcycle")


def write_network(
    path: Path, *boxes: tuple[float, float, float], size_m: tuple[float, float, float] = (4.6, 1.9, 1.6),
    class_index: int = 0, takes_paint: bool = True, said: Mapping[str, str] | None = None,
) -> Path:  # fmt: skip
    """A box of ``size_m`` for each x and y in the direction's frame and yaw in degrees; ``said`` replaces metadata."""
    output = np.zeros((1, Outputs.channels(len(CLASSES)), GRID.rows // STRIDE, GRID.columns // STRIDE), np.float32)
    output[:, Outputs.HEAT] = -10
    for x_m, y_m, yaw_deg in boxes:
        place = np.array([x_m - GRID.x_min_m, y_m - GRID.y_min_m]) / (GRID.cell_m * STRIDE)
        row, column = place.astype(int)
        yaw_rad = np.radians(yaw_deg)
        cell = output[0, :, row, column]
        cell[Outputs.HEAT], cell[Outputs.QUALITY] = 2, 2
        cell[Outputs.OFFSET] = (place - [row + 0.5, column + 0.5]) * GRID.cell_m * STRIDE
        cell[Outputs.HEIGHT] = size_m[2] / 2
        cell[Outputs.LOG_SIZE] = np.log(size_m)
        cell[Outputs.AXIS] = np.sin(2 * yaw_rad), np.cos(2 * yaw_rad)
        cell[Outputs.HEADING] = np.sin(yaw_rad), np.cos(yaw_rad)
        cell[Outputs.LOG_STD] = np.log([0.3, 0.1, 0.05])
        cell[Outputs.CLASSES + class_index] = 5
    features = features_of(columns_for(PAINTED_CLASSES if takes_paint else ()))
    graph = helper.make_graph(
        [
            # What the points say does not matter, but they must be there in the right form.
            helper.make_node("ReduceSum", ["points"], ["sum"], keepdims=0),
            helper.make_node("Cast", ["cells"], ["float_cells"], to=TensorProto.FLOAT),
            helper.make_node("ReduceSum", ["float_cells"], ["cell_sum"], keepdims=0),
            helper.make_node("Add", ["sum", "cell_sum"], ["all"]),
            helper.make_node("Mul", ["all", "zero"], ["nothing"]),
            helper.make_node("Add", ["map", "nothing"], ["output"]),
        ],
        "made pillars",
        [
            helper.make_tensor_value_info("points", TensorProto.FLOAT, ["pillars", POINTS_PER_PILLAR, features]),
            helper.make_tensor_value_info("cells", TensorProto.INT64, ["pillars"]),
        ],
        [helper.make_tensor_value_info("output", TensorProto.FLOAT, list(output.shape))],
        [numpy_helper.from_array(output, "map"), numpy_helper.from_array(np.array(0, np.float32), "zero")],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    metadata = {
        "task": "pillars",
        "classes": json.dumps(CLASSES),
        "painted": json.dumps(PAINTED_CLASSES if takes_paint else ()),
        "grid": json.dumps(asdict(GRID)),
    }
    helper.set_model_props(model, metadata | dict(said or {}))
    onnx.checker.check_model(model)
    onnx.save(model, str(path))
    return path
