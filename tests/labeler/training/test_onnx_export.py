"""The files say what torch says, at any batch and size, and the rooms that use them take them as they are."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch", reason="needs torch, of the extra `training`")
pytest.importorskip("onnx", reason="needs onnx, of the extra `training`")

import onnxruntime
import torch

from labeler.detection import DetectionConfig, open_detector
from labeler.segmentation import open_segmenter
from labeler.training.flat import FlatNetwork
from labeler.training.onnx_export import export_detector, export_segmentation
from labeler.training.segmentation_network import SegmentationNetwork
from labeler.training.yolox_network import Yolox, YoloxShape


def images(count: int, height: int, width: int) -> torch.Tensor:
    return torch.rand(count, 3, height, width, generator=torch.Generator().manual_seed(1)) * 255


def warmed_up(network: torch.nn.Module) -> torch.nn.Module:
    """With statistics of batch normalisation that are not those of a new one."""
    with torch.no_grad():
        for _ in range(3):
            network.train()(images(2, 64, 96))
    return network.eval()


@pytest.fixture(scope="module")
def detector() -> torch.nn.Module:
    torch.manual_seed(5)
    return warmed_up(Yolox(4, YoloxShape(depth=0.33, width=0.125, depthwise=True)))


@pytest.fixture(scope="module")
def segmentation() -> torch.nn.Module:
    torch.manual_seed(5)
    return warmed_up(SegmentationNetwork(5))


def run(file: Path, blob: torch.Tensor) -> np.ndarray:
    session = onnxruntime.InferenceSession(str(file), providers=["CPUExecutionProvider"])
    return np.asarray(session.run(None, {"images": blob.numpy()})[0])


@pytest.mark.parametrize("shape", [(1, 64, 96), (3, 96, 64)])
def test_a_detector_file_says_what_torch_says(
    detector: torch.nn.Module, tmp_path: Path, shape: tuple[int, int, int]
) -> None:
    export_detector(detector, tmp_path / "d.onnx", source="test")
    blob = images(*shape)
    with torch.no_grad():
        cells = detector(blob)

    found = run(tmp_path / "d.onnx", blob)

    assert found.shape == (shape[0], 126, 9)  # 8 x 12 + 4 x 6 + 2 x 3 cells; box, objectness, four classes
    # Half-precision weights have 11 bits: a part in two thousand each.
    np.testing.assert_allclose(found[..., :4], cells[..., :4].numpy(), atol=0.02)
    np.testing.assert_allclose(found[..., 4:], cells[..., 4:].sigmoid().numpy(), atol=0.01)
    assert [path.name for path in tmp_path.iterdir()] == ["d.onnx"]


def test_a_detector_file_runs_like_any_other_yolox(detector: torch.nn.Module, tmp_path: Path) -> None:
    export_detector(detector, tmp_path / "d.onnx", source="test")

    opened = open_detector(tmp_path / "d.onnx", DetectionConfig(min_score=1e-6), providers=("CPUExecutionProvider",))

    assert set(opened.class_names) == {"car", "truck", "bus", "motorcycle"}
    assert opened.input_shapes((360, 720)) == ((384, 736),)
    assert len(opened.detect([np.full((90, 120, 3), 114, np.uint8)])[0]) > 0


@pytest.mark.parametrize("shape", [(1, 64, 96), (2, 96, 128)])
def test_a_segmentation_file_says_what_torch_says(
    segmentation: torch.nn.Module, tmp_path: Path, shape: tuple[int, int, int]
) -> None:
    export_segmentation(segmentation, tmp_path / "s.onnx", source="test")
    blob = images(*shape)
    with torch.no_grad():
        expected = segmentation(blob).softmax(dim=1).numpy()

    found = run(tmp_path / "s.onnx", blob)

    assert found.shape == (shape[0], 5, shape[1] // 4, shape[2] // 4)
    np.testing.assert_allclose(found, expected, atol=0.01)


def test_a_segmentation_file_is_taken_by_the_room_that_paints(segmentation: torch.nn.Module, tmp_path: Path) -> None:
    export_segmentation(segmentation, tmp_path / "s.onnx", source="test")

    scores = open_segmenter(tmp_path / "s.onnx", providers=("CPUExecutionProvider",)).segment(
        np.full((90, 120, 3), 114, np.uint8)
    )

    assert scores.class_names == ("other", "road", "building", "vegetation", "vehicle")
    assert scores.stride_px == 4


def test_a_network_in_rows_is_the_same_network() -> None:
    torch.manual_seed(2)
    network = SegmentationNetwork(5)
    blob = images(2, 64, 64)
    plain = network(blob)
    flat = FlatNetwork(network)

    torch.testing.assert_close(network(blob), plain)  # other places in memory round otherwise
    network(blob).sum().backward()
    first = next(parameter for parameter in network.parameters())
    assert first.grad is not None
    assert torch.equal(flat.weights_grad[: first.numel()], first.grad.reshape(-1))
    flat.weights.zero_()  # the network's own weights are views of this row
    assert float(first.detach().abs().sum()) == 0.0
