"""The segment stage on the drive made by code, whose cars are the only red things in it."""

import shutil
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from labeler.drive import Drive, open_drive, read_image
from labeler.pipeline import SilentProgress, label_drive, open_executor, plan
from labeler.pipeline.artifacts import Artifacts
from labeler.pipeline.segmenting import SegmentationClip, SegmentUnit, segment
from labeler.segmentation import open_segmenter
from tests.made_drive import CAMERA_YAW_DEG
from tests.made_models import write_segmentation_model


@pytest.fixture
def model(tmp_path: Path) -> Path:
    return write_segmentation_model(tmp_path / "red.onnx", metadata={"classes": '["other", "vehicle"]'})


class _Recorder(SilentProgress):
    """Keeps how many units each stage had left to do."""

    def __init__(self) -> None:
        self.units: dict[str, int] = {}

    def stage(self, name: str, units: int) -> None:
        self.units[name] = units


def _segment(drive: Drive, model: Path, workspace: Path) -> tuple[list[SegmentUnit], list[Path], _Recorder]:
    artifacts, progress = Artifacts(workspace), _Recorder()
    units = plan.segment_units(drive, artifacts=artifacts, model=model)
    paths = segment(units, open_segmenter(model), artifacts=artifacts, threads=2, progress=progress)
    return units, paths, progress


def test_what_is_read_back_is_what_the_segmenter_says(made_drive: Path, model: Path, tmp_path: Path) -> None:
    drive = open_drive(made_drive)
    units, paths, _ = _segment(drive, model, tmp_path / "workspace")
    segmenter = open_segmenter(model)
    assert [unit.camera.name for unit in units] == list(CAMERA_YAW_DEG)
    for unit, path in zip(units, paths, strict=True):
        clip = SegmentationClip(path)
        for frame_index, file in unit.images:
            found = clip.at(frame_index)
            assert found is not None
            expected = segmenter.segment(read_image(file))
            np.testing.assert_array_equal(found.scores, expected.scores)
            assert found.class_names == ("other", "vehicle")
            assert (found.stride_px, found.size_px) == (expected.stride_px, expected.size_px)
        assert clip.at(len(drive.frames)) is None


def test_what_is_done_is_found_again(made_drive: Path, model: Path, tmp_path: Path) -> None:
    drive, workspace = open_drive(made_drive), tmp_path / "workspace"
    _, first, progress = _segment(drive, model, workspace)
    assert progress.units == {"segment": 24}
    _, again, progress = _segment(drive, model, workspace)
    assert (progress.units, again) == ({"segment": 0}, first)
    other = write_segmentation_model(tmp_path / "blue.onnx", channel=2)
    _, of_other, progress = _segment(drive, other, workspace)
    assert progress.units == {"segment": 24}
    assert not set(of_other) & set(first)


def test_an_image_that_is_broken_is_skipped_and_named(
    made_drive: Path, made_model: Path, model: Path, tmp_path: Path
) -> None:
    folder = shutil.copytree(made_drive, tmp_path / "drive")
    broken = sorted((folder / "sensors" / "cameras" / "left").glob("*.jpg"))[3]
    broken.write_bytes(broken.read_bytes()[:-100])
    with open_executor("serial") as executor:
        labelled = label_drive(
            open_drive(folder), model=made_model, segmentation=model, workspace=tmp_path, executor=executor
        )
    (warning,) = labelled.summary["warnings"]  # one, though detection met it, too
    assert broken.name in warning
    _, paths, _ = _segment(open_drive(folder), model, tmp_path)
    left = SegmentationClip(paths[1])
    assert left.at(2) is not None
    assert left.at(3) is None
    assert left.at(4) is not None


def test_a_clip_of_broken_images_has_no_scores(made_drive: Path, model: Path, tmp_path: Path) -> None:
    folder = shutil.copytree(made_drive, tmp_path / "drive")
    drive = open_drive(folder)
    for image in (folder / "sensors" / "cameras" / "left").glob("*.jpg"):
        image.write_bytes(b"")
    _, paths, _ = _segment(drive, model, tmp_path / "workspace")
    assert SegmentationClip(paths[1]).at(0) is None


def test_units_of_lidar_get_the_artifacts_and_depend_on_them(made_drive: Path, model: Path, tmp_path: Path) -> None:
    drive, artifacts = open_drive(made_drive), Artifacts(tmp_path / "workspace")
    units, paths, _ = _segment(drive, model, tmp_path / "workspace")
    segmented, nothing = plan.Clips.of(units, paths), plan.Clips.of([], [])
    classes, config = plan.Classes(("car",), (0,)), plan.LidarConfig()
    with_scores = plan.lidar_units(drive, nothing, segmented, classes, config, artifacts=artifacts)
    without = plan.lidar_units(drive, nothing, nothing, classes, config, artifacts=artifacts)
    assert [unit.segmentation for unit in with_scores] == [dict(zip(CAMERA_YAW_DEG, paths, strict=True))]
    assert [unit.segmentation for unit in without] == [{}]
    assert with_scores[0].key != without[0].key


@pytest.mark.parametrize("missing", ["sensors/lidar", "calibration"])
def test_a_drive_that_can_not_be_painted_is_not_segmented(
    made_drive: Path, made_model: Path, model: Path, tmp_path: Path, missing: str
) -> None:
    folder = shutil.copytree(made_drive, tmp_path / "drive")
    shutil.rmtree(folder / missing)
    progress = _Recorder()
    with open_executor("serial") as executor:
        label_drive(
            open_drive(folder),
            model=made_model,
            segmentation=model,
            workspace=tmp_path / "workspace",
            executor=executor,
            progress=progress,
        )
    assert "segment" not in progress.units


def test_its_time_is_in_the_summary(made_drive: Path, made_model: Path, model: Path, tmp_path: Path) -> None:
    with open_executor("serial") as executor:
        labels = partial(
            label_drive, open_drive(made_drive), model=made_model, workspace=tmp_path / "workspace", executor=executor
        )
        assert "segment" not in labels().summary["seconds"]
        assert labels(segmentation=model).summary["seconds"]["segment"] > 0
