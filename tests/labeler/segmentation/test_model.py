"""Segmentation files: what they say about themselves, and those that can't be used."""

import json
from pathlib import Path

import numpy as np
import pytest
from onnx import TensorProto, helper

from labeler.inference import ModelError
from labeler.segmentation import CITYSCAPES_CLASSES, SegmentationError, open_segmenter
from labeler.segmentation.model import SegmentationModel
from tests.made_models import save_model, write_segmentation_model


def test_a_file_that_says_nothing_gets_defaults(tmp_path: Path) -> None:
    layout = SegmentationModel(write_segmentation_model(tmp_path / "made.onnx", stride=4)).layout
    assert (layout.batch, layout.height, layout.width) == (None, None, None)
    assert layout.class_names == ("class_0", "class_1")
    assert (layout.stride_px, layout.multiple_px, layout.long_side_px) == (4, 32, 960)
    assert not layout.logits
    assert layout.reversed_colours


def test_a_file_that_says_everything_is_believed(tmp_path: Path) -> None:
    metadata = {
        "task": "segmentation",
        "classes": '["other", "vehicle"]',
        "stride": "8",
        "multiple": "16",
        "long_side_px": "720",
        "colour_order": "bgr",
        "mean": "[1, 2.5, 3]",
        "std": "[4, 5, 6]",
    }
    path = write_segmentation_model(tmp_path / "made.onnx", logits=True, hw=(32, 48), metadata=metadata)
    layout = SegmentationModel(path).layout
    assert layout.class_names == open_segmenter(path).class_names == ("other", "vehicle")
    assert (layout.height, layout.width, layout.multiple_px, layout.long_side_px) == (32, 48, 16, 720)
    assert (layout.mean, layout.std) == ((1, 2.5, 3), (4, 5, 6))
    assert layout.logits
    assert not layout.reversed_colours


def test_nineteen_classes_are_those_of_cityscapes(tmp_path: Path) -> None:
    path = save_model(
        tmp_path / "wide.onnx",
        [helper.make_node("Conv", ["images", "weight"], ["output"], strides=[8, 8])],
        {"weight": np.ones((19, 3, 8, 8), np.float32)},
        input_shape=(1, 3, "height", "width"),
        output_shape=(1, 19, "rows", "columns"),
    )
    assert open_segmenter(path).class_names == CITYSCAPES_CLASSES


@pytest.mark.parametrize(
    ("metadata", "complaint"),
    [
        ({"classes": '["vehicle"]'}, "names 1 classes .* scores for 2"),
        ({"classes": "vehicle, other"}, "'classes', which must be a JSON list"),
        ({"stride": "4"}, "say a stride of 4, but its output has 8"),
        ({"stride": "eight"}, "whole number above 0"),
        ({"multiple": "0"}, "whole number above 0"),
        ({"colour_order": "yuv"}, "rgb or bgr"),
        ({"mean": "[1, 2]"}, "three numbers"),
        ({"std": "[1, 0, 1]"}, "three numbers"),
        ({"std": json.dumps([1, "2", 3])}, "three numbers"),
    ],
)
def test_metadata_that_can_not_be_used_are_named(tmp_path: Path, metadata: dict[str, str], complaint: str) -> None:
    path = write_segmentation_model(tmp_path / "made.onnx", metadata=metadata)
    with pytest.raises(SegmentationError, match=rf"made\.onnx .*{complaint}"):
        open_segmenter(path)


def test_a_detector_is_no_segmentation(made_model: Path) -> None:
    with pytest.raises(SegmentationError, match=r"is not a segmentation model: .* gave an output of shape"):
        open_segmenter(made_model)


def test_a_file_of_class_numbers_is_no_segmentation(tmp_path: Path) -> None:
    path = save_model(
        tmp_path / "numbers.onnx",
        [helper.make_node("Cast", ["images"], ["output"], to=TensorProto.FLOAT)],
        {},
        input_shape=("batch", 3, "height", "width"),
        output_shape=("batch", 3, "height", "width"),
        input_type=TensorProto.UINT8,
    )
    with pytest.raises(SegmentationError, match=r"takes tensor\(uint8\)"):
        open_segmenter(path)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match=r"no model file .*absent\.onnx"):
        open_segmenter(tmp_path / "absent.onnx")
