from pathlib import Path

import numpy as np
import onnxruntime
import pytest
from onnx import helper

from labeler.inference import ModelError
from labeler.inference.sessions import GPU_PROVIDERS, open_session, preferred_providers
from tests.made_models import save_model


@pytest.fixture
def small_model(tmp_path: Path) -> Path:
    """A model of one convolution."""
    return save_model(
        tmp_path / "small.onnx",
        [helper.make_node("Conv", ["images", "weight"], ["output"])],
        {"weight": np.ones((8, 3, 3, 3), np.float32)},
        input_shape=("batch", 3, "height", "width"),
        output_shape=("batch", 8, "rows", "columns"),
    )


@pytest.mark.parametrize(
    ("available", "preferred"),
    [
        (["CPUExecutionProvider"], ("CPUExecutionProvider",)),
        (["AzureExecutionProvider", "CPUExecutionProvider"], ("CPUExecutionProvider",)),
        # TensorRT is never taken by itself
        (
            ["TensorrtExecutionProvider", "CUDAExecutionProvider", "CPUExecutionProvider"],
            ("CUDAExecutionProvider", "CPUExecutionProvider"),
        ),
        (["DmlExecutionProvider", "CPUExecutionProvider"], ("DmlExecutionProvider", "CPUExecutionProvider")),
        (["CPUExecutionProvider", "CoreMLExecutionProvider"], ("CoreMLExecutionProvider", "CPUExecutionProvider")),
    ],
)
def test_a_gpu_comes_first(available: list[str], preferred: tuple[str, ...]) -> None:
    assert preferred_providers(available) == preferred


def test_provider_asked_for_by_name_must_be_there(small_model: Path) -> None:
    with pytest.raises(ModelError, match=r"no provider NoSuchProvider .* It offers: .*CPUExecutionProvider"):
        open_session(small_model, providers=("NoSuchProvider",), intra_op_threads=1)


def test_no_provider_at_all_is_an_error(small_model: Path) -> None:
    with pytest.raises(ModelError, match="none was named"):
        open_session(small_model, providers=(), intra_op_threads=1)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match=r"no model file .*absent\.onnx"):
        open_session(tmp_path / "absent.onnx", providers=None, intra_op_threads=1)


def test_a_folder_is_no_model(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="is not a file"):
        open_session(tmp_path, providers=None, intra_op_threads=1)


def test_an_empty_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "empty.onnx").touch()
    with pytest.raises(ModelError, match=r"empty\.onnx is empty"):
        open_session(tmp_path / "empty.onnx", providers=None, intra_op_threads=1)


@pytest.mark.parametrize("content", [b"PK\x03\x04 a checkpoint is a zip", b"\x00" * 100, bytes(range(256)) * 4])
def test_a_file_of_another_kind_is_named(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "checkpoint.onnx"
    path.write_bytes(content)
    with pytest.raises(ModelError, match=r"checkpoint\.onnx can't be opened as an ONNX model"):
        open_session(path, providers=None, intra_op_threads=1)


def test_a_truncated_model_is_named(tmp_path: Path, small_model: Path) -> None:
    whole = small_model.read_bytes()
    path = tmp_path / "truncated.onnx"
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ModelError, match=r"truncated\.onnx can't be opened"):
        open_session(path, providers=None, intra_op_threads=1)


def test_session_says_what_it_runs_on(small_model: Path) -> None:
    session = open_session(small_model, providers=("CPUExecutionProvider",), intra_op_threads=1)
    assert session.providers == ("CPUExecutionProvider",)


def test_a_gpu_that_fails_to_start_is_left_with_a_warning(small_model: Path, caplog: pytest.LogCaptureFixture) -> None:
    absent = next(name for name in GPU_PROVIDERS if name not in onnxruntime.get_available_providers())
    session = open_session(small_model, providers=None, intra_op_threads=1, available=(absent, "CPUExecutionProvider"))
    assert session.providers == ("CPUExecutionProvider",)
    assert f"{absent} can't be used, going on without it" in caplog.text
