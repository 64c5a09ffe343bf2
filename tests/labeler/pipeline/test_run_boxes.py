"""Runs whose 3D boxes a pillar network makes, on the drive made by code: one car stands 12 m away, 20 degrees right."""

from pathlib import Path

import numpy as np
import pytest

from labeler.drive import open_drive
from labeler.inference import ModelError
from labeler.lidar import BoxSource
from labeler.pipeline import LabelledDrive, label_drive, open_executor
from tests.labeler.lidar.pillars.made_network import write_network

PARKED = (12 * float(np.cos(np.radians(20))), -12 * float(np.sin(np.radians(20))), 70.0)
CAR_M = (4.5, 1.8, 1.5)


def labelled(drive: Path, model: Path, workspace: Path, boxes: Path) -> LabelledDrive:
    with open_executor("serial") as executor:
        return label_drive(open_drive(drive), model=model, boxes=boxes, workspace=workspace, executor=executor)


def sources(found: LabelledDrive) -> set[int]:
    return {source for frame in found.frames() for view in frame.views.values() for source in view.boxes_3d.source}


def test_a_network_makes_the_boxes(made_drive: Path, made_model: Path, tmp_path: Path) -> None:
    network = write_network(tmp_path / "p.onnx", PARKED, size_m=CAR_M, takes_paint=False)
    found = labelled(made_drive, made_model, tmp_path / "workspace", network)
    assert BoxSource.PILLARS in sources(found)
    assert not any("without a network" in warning for warning in found.summary["warnings"])


def test_another_network_makes_other_boxes_and_the_same_one_elsewhere_the_same(
    made_drive: Path, made_model: Path, tmp_path: Path
) -> None:
    network = write_network(tmp_path / "p.onnx", PARKED, size_m=CAR_M, takes_paint=False)
    moved = tmp_path / "moved.onnx"
    moved.write_bytes(network.read_bytes())
    other = write_network(tmp_path / "other.onnx", takes_paint=False)
    keys = [labelled(made_drive, made_model, tmp_path / "workspace", file).key for file in (network, moved, other)]
    assert keys[0] == keys[1]
    assert keys[0] != keys[2]


def test_without_a_segmentation_a_painted_network_is_done_without_and_that_is_told(
    made_drive: Path, made_model: Path, tmp_path: Path
) -> None:
    network = write_network(tmp_path / "p.onnx", PARKED, size_m=CAR_M)
    found = labelled(made_drive, made_model, tmp_path / "workspace", network)
    assert sources(found) == {BoxSource.CLUSTER}
    (told,) = [warning for warning in found.summary["warnings"] if "without a network" in warning]
    assert "Name a segmentation by HINDSIGHT_SEGMENTATION" in told


def test_a_file_that_is_no_pillar_network_is_an_error(made_drive: Path, made_model: Path, tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="does not say that it is a pillar network"):
        labelled(made_drive, made_model, tmp_path / "workspace", made_model)
