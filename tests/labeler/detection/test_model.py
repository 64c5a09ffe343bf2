import json
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import onnx
import pytest
from numpy.typing import NDArray
from onnx import TensorProto, helper

from labeler.detection import COCO_CLASSES, DetectionError
from labeler.detection.model import YoloxModel

ModelMaker = Callable[..., Path]
_CELLS_64 = 84  # 64 x 64: 64 + 16 + 4


@pytest.mark.parametrize(
    ("batch", "hw", "decoded", "layout"),
    [
        ("batch", ("height", "width"), False, (None, None, None, False)),
        (1, (64, 96), False, (1, 64, 96, False)),
        (1, (64, 96), True, (1, 64, 96, True)),
        ("batch", (64, 96), True, (None, 64, 96, True)),
        (1, ("height", "width"), False, (1, None, None, False)),
    ],
)
def test_layout_is_seen_in_the_model(
    pixel_model: ModelMaker,
    batch: int | str,
    hw: Sequence[int | str],
    decoded: bool,
    layout: tuple[int | None, int | None, int | None, bool],
) -> None:
    seen = YoloxModel(pixel_model(batch=batch, hw=hw, decoded=decoded)).layout
    assert (seen.batch, seen.height, seen.width, seen.decoded) == layout
    assert seen.input_name == "images"


@pytest.mark.parametrize(
    ("classes", "metadata", "names"),
    [
        (80, {}, COCO_CLASSES),
        (2, {}, ("class_0", "class_1")),
        (2, {"names": json.dumps(["car", "van"])}, ("car", "van")),
        (2, {"classes": json.dumps(["car", "van"])}, ("car", "van")),
        # what the file says goes before the guess that 80 classes are COCO's
        (80, {"names": json.dumps([f"kind {index}" for index in range(80)])}, tuple(f"kind {i}" for i in range(80))),
        # not a list in JSON: not for us
        (2, {"names": "{0: 'car', 1: 'van'}"}, ("class_0", "class_1")),
        (2, {"names": '{"0": "car"}'}, ("class_0", "class_1")),
    ],
)
def test_names_of_classes(
    constant_model: ModelMaker, classes: int, metadata: dict[str, str], names: tuple[str, ...]
) -> None:
    path = constant_model(np.zeros((_CELLS_64, 5 + classes), np.float32), metadata=metadata)
    assert YoloxModel(path).layout.class_names == names


def test_names_that_do_not_fit_the_scores_are_an_error(constant_model: ModelMaker) -> None:
    path = constant_model(np.zeros((_CELLS_64, 7), np.float32), metadata={"names": '["car", "van", "bus"]'})
    with pytest.raises(DetectionError, match=r"names 3 classes .* scores for 2"):
        YoloxModel(path)


@pytest.mark.parametrize(
    ("rows", "hw", "reason"),
    [
        # YOLOv8 puts cells last
        (np.zeros((84, 8400), np.float32), (640, 640), "gave an output of shape 1x84x8400"),
        # YOLOv5 has three boxes in a cell
        (np.zeros((25200, 85), np.float32), (640, 640), "gave an output of shape 1x25200x85"),
        # a fourth stride, 64
        (np.zeros((85, 85), np.float32), (64, 64), "gave an output of shape 1x85x85"),
        # boxes and objectness, but no class
        (np.zeros((_CELLS_64, 5), np.float32), (64, 64), "gave an output of shape 1x84x5"),
        (np.zeros((_CELLS_64, 7), np.float32), (64, 72), "not multiples of 32"),
        (np.full((_CELLS_64, 7), -3, np.float32), (64, 64), "scores reach from -3 to -3"),
        (np.full((_CELLS_64, 7), 1.5, np.float32), (64, 64), "exported without the sigmoid"),
        (np.full((_CELLS_64, 7), np.nan, np.float32), (64, 64), "nothing but NaN"),
    ],
)
def test_another_network_is_refused_by_name(
    constant_model: ModelMaker, rows: NDArray[np.float32], hw: tuple[int, int], reason: str
) -> None:
    with pytest.raises(DetectionError) as caught:
        YoloxModel(constant_model(rows, hw=hw))
    message = str(caught.value)
    assert reason in message
    assert f"Its inputs: images tensor(float) 1x3x{hw[0]}x{hw[1]}" in message
    assert f"Its outputs: output tensor(float) 1x{rows.shape[0]}x{rows.shape[1]}" in message
    assert "A YOLOX model has one input" in message


@pytest.mark.parametrize(
    ("inputs", "reason"),
    [
        ([("images", TensorProto.UINT8, [1, 3, 64, 64])], "must both be 32-bit float"),
        ([("images", TensorProto.FLOAT, [1, 1, 64, 64])], "not a batch of colour images"),
        ([("tokens", TensorProto.FLOAT, [1, 77])], "not a batch of colour images"),
        (
            [("images", TensorProto.FLOAT, [1, 3, 64, 64]), ("size", TensorProto.FLOAT, [1, 2])],
            "it has 2 inputs and 1 outputs",
        ),
    ],
)
def test_another_interface_is_refused(tmp_path: Path, inputs: list[tuple[str, int, list[int]]], reason: str) -> None:
    first = inputs[0][0]
    graph = helper.make_graph(
        [helper.make_node("Cast", [first], ["output"], to=TensorProto.FLOAT)],
        "other",
        [helper.make_tensor_value_info(*each) for each in inputs],
        [helper.make_tensor_value_info("output", TensorProto.FLOAT, inputs[0][2])],
    )
    path = tmp_path / "other.onnx"
    onnx.save(helper.make_model(graph, opset_imports=[helper.make_opsetid("", 13)], ir_version=8), str(path))
    with pytest.raises(DetectionError, match=reason):
        YoloxModel(path)


def test_model_that_cannot_take_the_shape_it_promises_is_refused(pixel_model: ModelMaker, tmp_path: Path) -> None:
    """Decoding constants of one shape baked into a model whose sides claim to be free."""
    model = onnx.load(str(pixel_model(hw=(64, 96), decoded=True)))
    sides = model.graph.input[0].type.tensor_type.shape.dim
    sides[2].dim_param, sides[3].dim_param = "height", "width"
    path = tmp_path / "baked.onnx"
    onnx.save(model, str(path))
    with pytest.raises(DetectionError, match="can't run on an input of shape 1x3x128x160"):
        YoloxModel(path)


def test_failure_while_running_names_the_file_and_the_shape(pixel_model: ModelMaker) -> None:
    model = YoloxModel(pixel_model(hw=(64, 96)))
    with pytest.raises(DetectionError, match=r"pixel\.onnx failed on an input of shape 1x3x32x32"):
        model.run(np.zeros((1, 3, 32, 32), np.float32))


@pytest.mark.real_drive
def test_official_weights_are_read_right(yolox_nano_416: Path, yolox_nano_dynamic: Path) -> None:
    fixed, free = YoloxModel(yolox_nano_416).layout, YoloxModel(yolox_nano_dynamic).layout
    assert (fixed.batch, fixed.height, fixed.width, fixed.decoded) == (1, 416, 416, False)
    assert (free.batch, free.height, free.width, free.decoded) == (None, None, None, False)
    assert fixed.class_names == free.class_names == COCO_CLASSES
