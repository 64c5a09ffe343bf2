from collections.abc import Callable
from pathlib import Path

import onnxruntime
import pytest

from labeler.detection import DetectionError
from labeler.detection.sessions import GPU_PROVIDERS, open_session, preferred_providers

ModelMaker = Callable[..., Path]


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


def test_provider_asked_for_by_name_must_be_there(pixel_model: ModelMaker) -> None:
    with pytest.raises(DetectionError, match=r"no provider NoSuchProvider .* It offers: .*CPUExecutionProvider"):
        open_session(pixel_model(), providers=("NoSuchProvider",), intra_op_threads=1)


def test_no_provider_at_all_is_an_error(pixel_model: ModelMaker) -> None:
    with pytest.raises(DetectionError, match="none was named"):
        open_session(pixel_model(), providers=(), intra_op_threads=1)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(DetectionError, match=r"no model file .*absent\.onnx"):
        open_session(tmp_path / "absent.onnx", providers=None, intra_op_threads=1)


def test_a_folder_is_no_model(tmp_path: Path) -> None:
    with pytest.raises(DetectionError, match="is not a file"):
        open_session(tmp_path, providers=None, intra_op_threads=1)


def test_an_empty_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "empty.onnx").touch()
    with pytest.raises(DetectionError, match=r"empty\.onnx is empty"):
        open_session(tmp_path / "empty.onnx", providers=None, intra_op_threads=1)


@pytest.mark.parametrize("content", [b"PK\x03\x04 a checkpoint is a zip", b"\x00" * 100, bytes(range(256)) * 4])
def test_a_file_of_another_kind_is_named(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "checkpoint.onnx"
    path.write_bytes(content)
    with pytest.raises(DetectionError, match=r"checkpoint\.onnx can't be opened as an ONNX model"):
        open_session(path, providers=None, intra_op_threads=1)


def test_a_truncated_model_is_named(tmp_path: Path, pixel_model: ModelMaker) -> None:
    whole = pixel_model().read_bytes()
    path = tmp_path / "truncated.onnx"
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(DetectionError, match=r"truncated\.onnx can't be opened"):
        open_session(path, providers=None, intra_op_threads=1)


def test_session_says_what_it_runs_on(pixel_model: ModelMaker) -> None:
    session = open_session(pixel_model(), providers=("CPUExecutionProvider",), intra_op_threads=1)
    assert session.providers == ("CPUExecutionProvider",)


def test_a_gpu_that_fails_to_start_is_left_with_a_warning(
    pixel_model: ModelMaker, caplog: pytest.LogCaptureFixture
) -> None:
    absent = next(name for name in GPU_PROVIDERS if name not in onnxruntime.get_available_providers())
    session = open_session(
        pixel_model(), providers=None, intra_op_threads=1, available=(absent, "CPUExecutionProvider")
    )
    assert session.providers == ("CPUExecutionProvider",)
    assert f"{absent} can't be used, going on without it" in caplog.text
