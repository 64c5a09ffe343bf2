"""onnxruntime sessions: which provider, how many threads, and clear errors for files that can't be opened."""

from __future__ import annotations

import logging
import os
import threading
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from labeler.inference.errors import ModelError

CPU_PROVIDER = "CPUExecutionProvider"
GPU_PROVIDERS = (
    "CUDAExecutionProvider",
    "ROCMExecutionProvider",
    "MIGraphXExecutionProvider",
    "CoreMLExecutionProvider",
    "DmlExecutionProvider",
)
"""By preference. TensorRT is left out: it compiles for minutes for each new input shape. It can be asked for by name.
"""

_NO_TELEMETRY = "ORT_DISABLE_TELEMETRY"

_log = logging.getLogger(__name__)


class TensorInfo(Protocol):
    """An input or output of a model: ``type`` such as ``tensor(float)``; free sizes in ``shape`` are names or None."""

    @property
    def name(self) -> str: ...
    @property
    def type(self) -> str: ...
    @property
    def shape(self) -> Sequence[int | str | None]: ...


class _ModelMeta(Protocol):
    @property
    def custom_metadata_map(self) -> Mapping[str, str]: ...


class _Session(Protocol):
    def run(self, output_names: None, input_feed: Mapping[str, NDArray[Any]]) -> list[NDArray[np.float32]]: ...
    def get_inputs(self) -> Sequence[TensorInfo]: ...
    def get_outputs(self) -> Sequence[TensorInfo]: ...
    def get_providers(self) -> Sequence[str]: ...
    def get_modelmeta(self) -> _ModelMeta: ...


class _SessionOptions(Protocol):
    intra_op_num_threads: int
    log_severity_level: int
    enable_mem_pattern: bool


class _Onnxruntime(Protocol):
    def disable_telemetry_events(self) -> None: ...
    def get_available_providers(self) -> Sequence[str]: ...
    def SessionOptions(self) -> _SessionOptions: ...
    def InferenceSession(
        self, path_or_bytes: str, sess_options: _SessionOptions, *, providers: Sequence[str], enable_fallback: int
    ) -> _Session: ...


@cache
def _onnxruntime() -> _Onnxruntime:
    """onnxruntime, which has no types of its own, by the part of it that is in use.

    Loaded when it is first needed: worker processes that only read detections do without it. Builds of it from 1.32 on
    tell their maker of every session by way of the network, unless they are asked not to: nothing leaves this machine.
    """
    os.environ[_NO_TELEMETRY] = "1"  # read while it is loaded; the call alone comes too late
    loaded = cast(_Onnxruntime, import_module("onnxruntime"))
    loaded.disable_telemetry_events()
    return loaded


class OpenSession:
    """A model loaded by onnxruntime. ``run`` may be called from several threads at once."""

    def __init__(self, session: _Session) -> None:
        self._session = session
        self.inputs = tuple(session.get_inputs())
        self.outputs = tuple(session.get_outputs())
        self.metadata = dict(session.get_modelmeta().custom_metadata_map)
        self.providers = tuple(session.get_providers())
        # DirectML alone forbids concurrent runs of one session (onnxruntime's page on that provider).
        self._one_at_a_time = threading.Lock() if "DmlExecutionProvider" in self.providers else None

    def run(self, feeds: Mapping[str, NDArray[Any]]) -> list[NDArray[np.float32]]:
        """All outputs for these inputs by name. Raises whatever onnxruntime raises."""
        if self._one_at_a_time is None:
            return self._session.run(None, feeds)
        with self._one_at_a_time:
            return self._session.run(None, feeds)


def preferred_providers(available: Sequence[str]) -> tuple[str, ...]:
    """Of what onnxruntime offers: the GPU providers that this project uses, best first, then the CPU."""
    return (*(name for name in GPU_PROVIDERS if name in available), CPU_PROVIDER)


def open_session(
    path: Path, *, providers: Sequence[str] | None, intra_op_threads: int, available: Sequence[str] | None = None
) -> OpenSession:
    """Load an ONNX file.

    With ``providers`` None each preferred one of the ``available`` (None asks onnxruntime) is tried in turn, with a
    logged warning for one that fails to start. Providers asked for by name must work. Raises ModelError when they
    don't, or when the file is no ONNX model.
    """
    _require_file(path)
    if available is None:
        available = _onnxruntime().get_available_providers()
    if providers is not None:
        missing = [name for name in providers if name not in available]
        if missing or not providers:
            raise ModelError(
                f"onnxruntime offers no provider {', '.join(missing) or '(none was named)'} on this machine. "
                f"It offers: {', '.join(available)}."
            )
        return _load(path, providers, intra_op_threads)
    *gpus, cpu = preferred_providers(available)
    for gpu in gpus:
        try:
            return _load(path, (gpu, cpu), intra_op_threads)
        except ModelError as error:
            _log.warning("%s can't be used, going on without it: %s", gpu, error)
    return _load(path, (cpu,), intra_op_threads)


def _load(path: Path, providers: Sequence[str], intra_op_threads: int) -> OpenSession:
    options = _onnxruntime().SessionOptions()
    options.intra_op_num_threads = intra_op_threads
    options.log_severity_level = 3  # errors only: the rest is chatter on standard error
    if "DmlExecutionProvider" in providers:
        options.enable_mem_pattern = False  # DirectML demands it
    try:
        # Without enable_fallback=0 onnxruntime prints to standard output, which belongs to --json.
        session = _onnxruntime().InferenceSession(str(path), options, providers=list(providers), enable_fallback=0)
    except Exception as error:  # onnxruntime's errors share no other base class
        if providers[0] != CPU_PROVIDER:
            raise ModelError(f"{path} could not be loaded with {providers[0]}: {error}") from error
        raise ModelError(
            f"{path} can't be opened as an ONNX model: {error}. Is it the whole .onnx file, not a checkpoint (.pth) or "
            "a broken download?"
        ) from error
    opened = OpenSession(session)
    if opened.providers[0] != providers[0]:
        raise ModelError(
            f"{providers[0]} failed to start, see onnxruntime's own message; in use would be: "
            f"{', '.join(opened.providers)}."
        )
    return opened


def _require_file(path: Path) -> None:
    if not path.exists():
        raise ModelError(f"There is no model file {path}.")
    if not path.is_file():
        raise ModelError(f"{path} is not a file. Give the path of an .onnx file.")
    if path.stat().st_size == 0:
        raise ModelError(f"{path} is empty. Copy or download the model again.")
