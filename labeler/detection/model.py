"""A YOLOX model file on onnxruntime: opened, looked at, and run.

Nothing is asked about the file that the file can say itself: which sides of the input are free, how many classes there
are, what they are called, and, from one run on noise, whether boxes come raw or decoded.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np
from numpy.typing import NDArray

from labeler.detection.classes import COCO_CLASSES
from labeler.detection.config import LARGEST_STRIDE_PX
from labeler.detection.decode import anchor_grid, looks_decoded
from labeler.detection.errors import DetectionError
from labeler.inference import OpenSession, TensorInfo, open_session

_PROBE_HW = (128, 160)
_EXPECTED = (
    "A YOLOX model has one input, float batch x 3 x height x width, and one output, float batch x cells x "
    "(5 + classes), where cells = height * width * (1/64 + 1/256 + 1/1024). The official tools/export_onnx.py of YOLOX "
    "makes one."
)


@dataclass(frozen=True)
class ModelLayout:
    """What a model takes and gives. ``batch``, ``height`` and ``width`` are None where free; sides are in pixels."""

    input_name: str
    batch: int | None
    height: int | None
    width: int | None
    class_names: tuple[str, ...]
    decoded: bool


class YoloxModel:
    """An open YOLOX file. ``run`` may be called from several threads at once."""

    def __init__(self, path: Path | str, *, providers: Sequence[str] | None = None, intra_op_threads: int = 1) -> None:
        """Open and check a file.

        ``providers`` are onnxruntime's names, best first; None takes a GPU where onnxruntime offers one.
        ``intra_op_threads`` is how many cores one run on the CPU uses; 0 lets onnxruntime choose. Raises
        DetectionError when the file is missing, not an ONNX model, or not a YOLOX model.
        """
        self.path = Path(path)
        self._session: OpenSession = open_session(self.path, providers=providers, intra_op_threads=intra_op_threads)
        self.layout = _look(self._session, self.path)

    @property
    def providers(self) -> tuple[str, ...]:
        """The onnxruntime providers in use, the one that does most of the work first."""
        return self._session.providers

    def run(self, blob: NDArray[np.float32]) -> NDArray[np.float32]:
        """(N, 3, H, W) float32 letterboxed images to the (N, A, 5 + C) float32 output as the model gives it.

        Raises DetectionError when onnxruntime fails, out of memory for instance."""
        try:
            return self._session.run({self.layout.input_name: blob})[0]
        except Exception as error:  # onnxruntime's errors share no other base class
            raise DetectionError(
                f"{self.path} failed on an input of shape {_times(blob.shape)}: {error}. Try a smaller input or batch."
            ) from error


def _look(session: OpenSession, path: Path) -> ModelLayout:
    inputs, outputs = session.inputs, session.outputs

    def refuse(reason: str) -> DetectionError:
        return DetectionError(
            f"{path} is not a YOLOX model: {reason}. Its inputs: {_describe(inputs)}. Its outputs: "
            f"{_describe(outputs)}. {_EXPECTED}"
        )

    if len(inputs) != 1 or len(outputs) != 1:
        raise refuse(f"it has {len(inputs)} inputs and {len(outputs)} outputs")
    if inputs[0].type != "tensor(float)" or outputs[0].type != "tensor(float)":
        raise refuse("its input and output must both be 32-bit float")
    sizes = [size if isinstance(size, int) and size > 0 else None for size in inputs[0].shape]
    if len(sizes) != 4 or sizes[1] not in (3, None):
        raise refuse("its input is not a batch of colour images")
    batch, _, height, width = sizes
    if any(side is not None and side % LARGEST_STRIDE_PX for side in (height, width)):
        raise refuse(f"the sides of its input are not multiples of {LARGEST_STRIDE_PX}")

    probe_hw = height or _PROBE_HW[0], width or _PROBE_HW[1]
    noise = np.random.default_rng(0).integers(0, 256, (batch or 1, 3, *probe_hw)).astype(np.float32)
    try:
        output = session.run({inputs[0].name: noise})[0]
    except Exception as error:  # onnxruntime's errors share no other base class
        raise refuse(f"it can't run on an input of shape {_times(noise.shape)}: {error}") from error

    grid = anchor_grid(probe_hw)
    if output.ndim != 3 or output.shape[:2] != (batch or 1, len(grid)) or output.shape[2] < 6:
        raise refuse(f"for an input of shape {_times(noise.shape)} it gave an output of shape {_times(output.shape)}")
    rows = output[0]
    if not np.isfinite(rows).all(axis=1).any():
        raise refuse("it gives nothing but NaN or infinity")
    scores = rows[:, 4:][np.isfinite(rows[:, 4:])]
    if scores.min() < -1e-3 or scores.max() > 1 + 1e-3:
        raise refuse(
            f"its scores reach from {scores.min():.3g} to {scores.max():.3g}, but must be probabilities; "
            "was it exported without the sigmoid?"
        )
    names = _class_names(session.metadata, rows.shape[1] - 5, path)
    return ModelLayout(inputs[0].name, batch, height, width, names, looks_decoded(rows, grid))


def _class_names(metadata: Mapping[str, str], count: int, path: Path) -> tuple[str, ...]:
    """What the model's metadata say under ``names`` or ``classes``, a JSON list; else COCO's for 80; else class_0...

    Official exports say nothing. Raises DetectionError when a list is there but does not fit."""
    for key in ("names", "classes"):
        if key not in metadata:
            continue
        try:
            names: object = json.loads(metadata[key])
        except ValueError:
            continue
        if isinstance(names, list):
            listed = [str(name) for name in cast(list[object], names)]
            if len(listed) != count:
                raise DetectionError(
                    f"{path} names {len(listed)} classes in its metadata {key!r} but puts out scores for {count}. "
                    "Export it again, with the names it was trained for."
                )
            return tuple(listed)
    return COCO_CLASSES if count == len(COCO_CLASSES) else tuple(f"class_{index}" for index in range(count))


def _describe(nodes: Sequence[TensorInfo]) -> str:
    return ", ".join(f"{node.name} {node.type} {_times(node.shape)}" for node in nodes) or "none"


def _times(shape: Sequence[int | str | None]) -> str:
    return "x".join("?" if size is None else str(size) for size in shape) or "of unknown shape"
