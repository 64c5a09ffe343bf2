"""Every model that Hindsight knows by name: those that ship with it, and the official YOLOX files that it can pull.

The official files are the ONNX exports of release 0.1.1rc0 of github.com/Megvii-BaseDetection/YOLOX, trained on COCO,
as demo/ONNXRuntime/README.md lists them there. That release publishes no checksums. The sha256 below are those that the
package SciML/YOLOWeights.jl pins the same files by; other public projects that pin them give the same, and the same
sizes, and opencv/opencv_zoo holds the file of yolox-s under the same sha256 (object_detection_yolox_2022nov.onnx).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from labeler.detection.classes import COCO_CLASSES

RELEASE_URL = "https://github.com/Megvii-BaseDetection/YOLOX/releases/download/0.1.1rc0"
WEIGHTS_FOLDER = Path(__file__).parent / "weights"


class Task(StrEnum):
    """What a model does."""

    DETECTION = "detection"
    SEGMENTATION = "segmentation"
    BOXES = "boxes"


@dataclass(frozen=True)
class OfficialModel:
    """A model that can be pulled. ``file`` is its name at the source, ``sha256`` and ``size_bytes`` are those of the
    published file, None where nobody has published them; ``input_shape`` is batch x channels x height x width."""

    name: str
    file: str
    sha256: str | None
    size_bytes: int | None
    input_shape: str
    task: Task = Task.DETECTION
    licence: str = "Apache-2.0"
    class_names: tuple[str, ...] = COCO_CLASSES

    @property
    def url(self) -> str:
        """Where it was published."""
        return f"{RELEASE_URL}/{self.file}"


@dataclass(frozen=True)
class ShippedModel:
    """A model that lies in the package, trained on simulated drives, with its model card beside it."""

    name: str
    task: Task
    sha256: str
    source: str = "trained on simulated drives; ships with Hindsight"
    licence: str = "Apache-2.0"

    @property
    def path(self) -> Path:
        return WEIGHTS_FOLDER / f"{self.name}.onnx"


OFFICIAL = (
    OfficialModel(
        "yolox-nano",
        "yolox_nano.onnx",
        "c789161ed43c8269fcd4e67c67eeeb4e80c622da2eb296a20bc6007bd18a0b7d",
        3_659_407,
        "1x3x416x416",
    ),
    OfficialModel(
        "yolox-tiny",
        "yolox_tiny.onnx",
        "427cc366d34e27ff7a03e2899b5e3671425c262ea2291f88bb942bc1cc70b0f7",
        20_219_662,
        "1x3x416x416",
    ),
    OfficialModel(
        "yolox-s",
        "yolox_s.onnx",
        "c5c2d13e59ae883e6af3b45daea64af4833a4951c92d116ec270d9ddbe998063",
        35_858_002,
        "1x3x640x640",
    ),
    OfficialModel(
        "yolox-m",
        "yolox_m.onnx",
        "21ff6cfdeb53b013bac2249599e55f00bff3cfdfdab37ed7a4620818c1d15b3f",
        101_259_744,
        "1x3x640x640",
    ),
    OfficialModel(
        "yolox-l",
        "yolox_l.onnx",
        "7860ae79de6c89a3c1eb72ae9a2756c0ccfbe04b7791bb5880afabd97855a411",
        216_746_733,
        "1x3x640x640",
    ),
    OfficialModel(
        "yolox-x",
        "yolox_x.onnx",
        "c892d7aaf1c4746d8a4d675bec669a4db4f434b4ee1efb654bc9b353379c7c55",
        396_142_663,
        "1x3x640x640",
    ),
)
"""From the smallest to the best."""

SHIPPED = (
    ShippedModel("sim-yolox-nano", Task.DETECTION, "9fa94c37d3436c46b6d112c16fc5005eaa4a2d1b954e3d5dfc052f9b1022060e"),
    ShippedModel(
        "sim-segmentation", Task.SEGMENTATION, "291426d1c092b42c9ac2f09763a383db3d30977643a092f7b6dd6018d99726ee"
    ),
    ShippedModel("sim-pillars", Task.BOXES, "ec7fad152810de3fa92dfd1dac75309f9972926987ea1e3dcc019ec0e86593e8"),
)


def registered_names() -> tuple[str, ...]:
    """The names that no other model can take."""
    return tuple(model.name for model in (*SHIPPED, *OFFICIAL))
