"""Model files in ONNX form on onnxruntime: opened once, run from several threads. Detection and segmentation use it."""

from labeler.inference.errors import ModelError
from labeler.inference.sessions import CPU_PROVIDER, OpenSession, TensorInfo, open_session

__all__ = ["CPU_PROVIDER", "ModelError", "OpenSession", "TensorInfo", "open_session"]
