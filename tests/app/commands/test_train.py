"""``hindsight train`` from end to end, as small as it gets."""

import json
from pathlib import Path

import onnxruntime
import pytest
from typer.testing import CliRunner

from app.cli import main
from tests.labeler.training.test_clouds import one_frame
from tests.labeler.training.test_pictures import make_drive


def run(*arguments: str) -> str:
    result = CliRunner().invoke(main, ["train", *arguments])
    assert result.exit_code == 0, result.output
    return result.stdout


@pytest.mark.parametrize(
    ("task", "file", "column"),
    [("detector", "sim-yolox-nano.onnx", "AP@.5"), ("segmentation", "sim-segmentation.onnx", "IoU")],
)
def test_a_model_is_trained_written_and_measured(tmp_path: Path, task: str, file: str, column: str) -> None:
    for package in ("torch", "onnx"):
        pytest.importorskip(package, reason=f"needs {package}, of the extra `training`")
    make_drive(tmp_path / "drives" / "train0")
    options = ("--drives", str(tmp_path / "drives"), "--steps", "2", "--batch-size", "2")

    run(task, str(tmp_path / "run"), *options)
    metadata = onnxruntime.InferenceSession(tmp_path / "run" / file).get_modelmeta().custom_metadata_map
    assert "--batch-size 2 --workers" in metadata["source"]
    assert "from step 0 with --device cpu; from step 0: train0" in metadata["source"]
    report = json.loads(run("validate", str(tmp_path / "run" / file), "--drives", str(tmp_path / "drives"), "--json"))

    assert (report["model"], report["images"], report["drives"]) == (file, 1, ["train0"])
    table = run("validate", str(tmp_path / "run" / file), "--drives", str(tmp_path / "drives"))
    assert column in table


def test_a_pillar_network_is_trained_written_and_measured(tmp_path: Path) -> None:
    for package in ("torch", "onnx"):
        pytest.importorskip(package, reason=f"needs {package}, of the extra `training`")
    drives = ("--drives", str(one_frame(tmp_path / "drives" / "train0").parent))

    run("pillars", str(tmp_path / "run"), *drives, "--steps", "2", "--batch-size", "2")
    file = str(tmp_path / "run" / "sim-pillars.onnx")
    report = json.loads(run("validate", file, *drives, "--json"))

    assert (report["model"], report["painted"], report["directions"]) == ("sim-pillars.onnx", True, 4)
    assert "right class" in run("validate", file, *drives)
    assert [path.name[:7] for path in (tmp_path / "clouds").iterdir()] == ["train0-"]


@pytest.mark.parametrize("task", ["detector", "segmentation", "pillars"])
def test_a_gpu_that_is_not_there_is_said_to_be_missing(tmp_path: Path, task: str) -> None:
    torch = pytest.importorskip("torch", reason="needs torch, of the extra `training`")
    if torch.cuda.is_available():
        pytest.skip("there is a GPU")
    result = CliRunner().invoke(main, ["train", task, str(tmp_path / "run"), "-d", "nowhere", "--device", "cuda"])

    assert result.exit_code == 1
    assert "needs an NVIDIA GPU that torch can use" in " ".join(result.stderr.split())
    assert not (tmp_path / "run").exists()


def test_pillars_need_a_painter(tmp_path: Path) -> None:
    result = CliRunner().invoke(main, ["train", "pillars", str(tmp_path / "run"), "-d", "nowhere", "--painter", "none"])

    assert result.exit_code == 1
    assert "Points need a segmentation" in result.stderr


def test_a_folder_without_drives_is_named(tmp_path: Path) -> None:
    result = CliRunner().invoke(main, ["train", "validate", "model.onnx", "--drives", str(tmp_path / "nowhere")])

    assert result.exit_code == 1
    assert "There is no drive in" in result.stderr
