"""A segmentation model file on onnxruntime: opened, looked at, and run.

What a file can't say by its shapes, it says in its ONNX metadata (``metadata_props``), all of them optional:

- ``classes``: a JSON list of the names of its classes. Without it, 19 classes are Cityscapes's, others class_0, ...
- ``colour_order``: ``rgb`` (default) or ``bgr``.
- ``mean`` and ``std``: JSON lists of three numbers in 0..255, subtracted and divided by; without them the network
  takes 0..255 as it is.
- ``multiple``: what the sides of its input must be multiples of, in pixels (default 32).
- ``long_side_px``: an image whose longer side is longer is shrunk to it (default 960).
- ``stride``: compared with what a run on noise gives.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np
from numpy.typing import NDArray

from labeler.inference import OpenSession, open_session
from labeler.segmentation.errors import SegmentationError

CITYSCAPES_CLASSES = (
    "road", "sidewalk", "building", "wall", "fence", "pole", "traffic light", "traffic sign", "vegetation", "terrain",
    "sky", "person", "rider", "car", "truck", "bus", "train", "motorcycle", "bicycle",
)  # fmt: skip
"""The training ids of https://www.cityscapes-dataset.com, in their order."""

_DEFAULT_MULTIPLE_PX = 32
_DEFAULT_LONG_SIDE_PX = 960
_PROBE_CELLS = (2, 3)
_EXPECTED = (
    "A segmentation model has one input, float batch x 3 x height x width, and one output, float batch x classes x "
    "rows x columns, of probabilities or logits."
)


@dataclass(frozen=True)
class SegmentationLayout:
    """What a model takes and gives. ``batch``, ``height`` and ``width`` are None where free; lengths are in pixels.

    ``mean`` and ``std`` are in the order of the input's channels; ``logits`` says that its output is no probability
    yet."""

    input_name: str
    batch: int | None
    height: int | None
    width: int | None
    class_names: tuple[str, ...]
    stride_px: int
    logits: bool
    reversed_colours: bool
    mean: tuple[float, float, float]
    std: tuple[float, float, float]
    multiple_px: int
    long_side_px: int


class SegmentationModel:
    """An open segmentation file. ``run`` may be called from several threads at once."""

    def __init__(self, path: Path | str, *, providers: Sequence[str] | None = None, intra_op_threads: int = 1) -> None:
        """Open and check a file; ``providers`` and ``intra_op_threads`` as for a detector.

        Raises ModelError when the file is missing, is not an ONNX model, or not a segmentation model.
        """
        self.path = Path(path)
        self._session: OpenSession = open_session(self.path, providers=providers, intra_op_threads=intra_op_threads)
        self.layout = _look(self._session, self.path)

    @property
    def providers(self) -> tuple[str, ...]:
        """The onnxruntime providers in use, the one that does most of the work first."""
        return self._session.providers

    def run(self, blob: NDArray[np.float32]) -> NDArray[np.float32]:
        """(N, 3, H, W) float32 inputs to the (N, C, H / stride, W / stride) float32 output as the model gives it.

        Raises SegmentationError when onnxruntime fails, out of memory for instance."""
        try:
            return self._session.run({self.layout.input_name: blob})[0]
        except Exception as error:  # onnxruntime's errors share no other base class
            raise SegmentationError(f"{self.path} failed on an input of shape {blob.shape}: {error}.") from error


def _look(session: OpenSession, path: Path) -> SegmentationLayout:
    inputs, outputs = session.inputs, session.outputs

    def refuse(reason: str) -> SegmentationError:
        return SegmentationError(f"{path} is not a segmentation model: {reason}. {_EXPECTED}")

    if len(inputs) != 1 or len(outputs) != 1:
        raise refuse(f"it has {len(inputs)} inputs and {len(outputs)} outputs")
    if inputs[0].type != "tensor(float)" or outputs[0].type != "tensor(float)":
        raise refuse(f"it takes {inputs[0].type} and gives {outputs[0].type}, and both must be 32-bit float")
    sizes = [size if isinstance(size, int) and size > 0 else None for size in inputs[0].shape]
    if len(sizes) != 4 or sizes[1] not in (3, None):
        raise refuse("its input is not a batch of colour images")
    batch, _, height, width = sizes
    said = _Metadata(session.metadata, path)
    multiple_px = said.positive("multiple", _DEFAULT_MULTIPLE_PX)
    probe_hw = height or _PROBE_CELLS[0] * multiple_px, width or _PROBE_CELLS[1] * multiple_px
    noise = np.random.default_rng(0).integers(0, 256, (batch or 1, 3, *probe_hw)).astype(np.float32)
    try:
        output = session.run({inputs[0].name: noise})[0]
    except Exception as error:  # onnxruntime's errors share no other base class
        raise refuse(f"it can't run on an input of shape {noise.shape}: {error}") from error
    if output.ndim != 4 or output.shape[0] != (batch or 1) or min(output.shape) < 1:
        raise refuse(f"for an input of shape {noise.shape} it gave an output of shape {output.shape}")
    stride_px = probe_hw[1] // output.shape[3]
    if (output.shape[2] * stride_px, output.shape[3] * stride_px) != probe_hw:
        raise refuse(f"its output of {output.shape[2]}x{output.shape[3]} does not divide its input, {probe_hw}")
    if said.positive("stride", stride_px) != stride_px:
        raise refuse(f"its metadata say a stride of {session.metadata['stride']}, but its output has {stride_px}")
    return SegmentationLayout(
        inputs[0].name,
        batch,
        height,
        width,
        said.class_names(output.shape[1]),
        stride_px,
        logits=not _are_probabilities(output),
        reversed_colours=said.choice("colour_order", ("rgb", "bgr")) == "rgb",
        mean=said.three("mean", 0.0),
        std=said.three("std", 1.0),
        multiple_px=multiple_px,
        long_side_px=said.positive("long_side_px", _DEFAULT_LONG_SIDE_PX),
    )


def _are_probabilities(output: NDArray[np.float32]) -> bool:
    """Whether the classes of every cell sum to 1 and none is below 0."""
    return bool((output >= -1e-3).all() and np.allclose(output.sum(axis=1), 1, atol=1e-2))


class _Metadata:
    """What a file says about itself. Each method raises SegmentationError for a value that can't be used."""

    def __init__(self, values: Mapping[str, str], path: Path) -> None:
        self._values = values
        self._path = path

    def positive(self, key: str, default: int) -> int:
        if key not in self._values:
            return default
        text = self._values[key].strip()
        if not text.isdecimal() or int(text) < 1:
            raise self._unusable(key, "a whole number above 0")
        return int(text)

    def choice(self, key: str, allowed: tuple[str, ...]) -> str:
        value = self._values.get(key, allowed[0]).strip().lower()
        if value not in allowed:
            raise self._unusable(key, " or ".join(allowed))
        return value

    def three(self, key: str, default: float) -> tuple[float, float, float]:
        listed = self._list(key)
        if listed is None:
            return (default, default, default)
        numbers = [float(value) for value in listed if isinstance(value, int | float)]
        if len(listed) != 3 or len(numbers) != 3 or not np.isfinite(numbers).all() or (key == "std" and 0 in numbers):
            raise self._unusable(key, "a JSON list of three numbers")
        return (numbers[0], numbers[1], numbers[2])

    def class_names(self, count: int) -> tuple[str, ...]:
        listed = self._list("classes")
        if listed is None:
            is_cityscapes = count == len(CITYSCAPES_CLASSES)
            return CITYSCAPES_CLASSES if is_cityscapes else tuple(f"class_{index}" for index in range(count))
        if len(listed) != count:
            raise SegmentationError(
                f"{self._path} names {len(listed)} classes in its metadata 'classes' but puts out scores for {count}. "
                "Export it again, with the names it was trained for."
            )
        return tuple(str(name) for name in listed)

    def _list(self, key: str) -> list[object] | None:
        if key not in self._values:
            return None
        try:
            value: object = json.loads(self._values[key])
        except ValueError:
            value = None
        if not isinstance(value, list):
            raise self._unusable(key, "a JSON list")
        return cast(list[object], value)

    def _unusable(self, key: str, wanted: str) -> SegmentationError:
        return SegmentationError(
            f"{self._path} says {self._values[key]!r} in its metadata {key!r}, which must be {wanted}. Export it again."
        )
