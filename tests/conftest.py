"""Drives and models for tests: recorded ones from ../shared, which not every machine has, and ones made by code."""

import os
from pathlib import Path

import pytest

from tests.made_drive import write_drive, write_model

os.environ["ORT_DISABLE_TELEMETRY"] = "1"  # for tests that load onnxruntime by themselves

SHARED = Path(__file__).resolve().parents[2] / "shared"


@pytest.fixture(scope="session", autouse=True)
def models_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An empty folder of models, in place of the one that this machine's user may have filled."""
    folder = tmp_path_factory.mktemp("models cache")
    os.environ["HINDSIGHT_MODELS"] = str(folder)
    for name in ("HINDSIGHT_MODEL", "HINDSIGHT_SEGMENTATION", "HINDSIGHT_BOXES", "HINDSIGHT_MODEL_MIRROR"):
        os.environ.pop(name, None)
    return folder


def _shared(relative: str) -> Path:
    path = SHARED / relative
    if not path.exists():
        pytest.skip(f"needs ../shared/{relative}, which is not on this machine")
    return path


@pytest.fixture(scope="session")
def tri_scene_01() -> Path:
    """A real drive in the Argoverse 2 layout: three cameras, LiDAR, poses, truth; 3 frames."""
    return _shared("drives/tri_scene_01")


@pytest.fixture(scope="session")
def kitti_0052() -> Path:
    """A real drive in the KITTI tracking layout: one camera, LiDAR, no poses; 40 frames."""
    return _shared("drives/kitti_0052")


@pytest.fixture(scope="session")
def nuscenes_one_sample() -> Path:
    """One real nuScenes sample: six cameras, LiDAR, poses."""
    return _shared("drives/nuscenes_one_sample")


@pytest.fixture(scope="session")
def yolox_nano_dynamic() -> Path:
    """YOLOX-nano, COCO, free batch, height and width."""
    return _shared("models/yolox_nano_dynamic.onnx")


@pytest.fixture(scope="session")
def yolox_nano_416() -> Path:
    """YOLOX-nano, COCO, fixed 1x3x416x416."""
    return _shared("models/yolox_nano_416.onnx")


@pytest.fixture(scope="session")
def kitti_tracking_text() -> Path:
    """KITTI tracking 0000-0010 as text: truth with ids and YOLOX detections."""
    return _shared("mot/kitti_tracking")


@pytest.fixture(scope="session")
def made_drive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small drive made by code: two cameras, LiDAR, poses, 12 frames; one of its two cars is seen by both cameras."""
    return write_drive(tmp_path_factory.mktemp("drives") / "made drive")


@pytest.fixture(scope="session")
def made_model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A YOLOX-shaped model that finds the cars of ``made_drive``."""
    return write_model(tmp_path_factory.mktemp("models") / "made.onnx")
