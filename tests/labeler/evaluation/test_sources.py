"""The labels of a real run of the pipeline, as evaluation reads them."""

from pathlib import Path

import numpy as np
import pytest

from labeler.drive import Drive, open_drive
from labeler.drive.types import Truth, TruthBoxes2D
from labeler.evaluation.evaluate import evaluate_labels
from labeler.evaluation.sources import detections_of_result, labels_of_run
from labeler.evaluation.types import EvaluationConfig
from labeler.pipeline import LabelledDrive, label_drive, open_executor

CAMERAS = ("front", "left")


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("workspace")


@pytest.fixture(scope="module")
def drive(made_drive: Path) -> Drive:
    return open_drive(made_drive)


@pytest.fixture(scope="module")
def labelled(drive: Drive, made_model: Path, workspace: Path) -> LabelledDrive:
    with open_executor("serial") as executor:
        return label_drive(drive, model=made_model, workspace=workspace, executor=executor)


def truth_of_observations(labelled: LabelledDrive) -> Truth:
    """Truth that says just what the tracks say, so that all of it can be found."""
    parts = [(camera, view.observations) for frame in labelled.frames() for camera, view in frame.views.items()]
    return Truth(
        TruthBoxes2D(
            frame_index=np.concatenate([seen.frame_index for _, seen in parts]),
            camera=tuple(camera for camera, seen in parts for _ in range(len(seen))),
            track_uuid=tuple(
                str(labelled.identity_of.get(track, track)) for _, seen in parts for track in seen.track_id.tolist()
            ),
            category=("car",) * sum(len(seen) for _, seen in parts),
            xyxy_px=np.concatenate([seen.xyxy_px for _, seen in parts]),
        ),
        None,
    )


def test_labels_that_are_their_own_truth_are_all_right(drive: Drive, labelled: LabelledDrive, workspace: Path):
    found = evaluate_labels(
        labels_of_run(labelled, drive, workspace=workspace),
        truth_of_observations(labelled),
        drive_name="made",
        config=EvaluationConfig(confidence=0.0),
    )
    observations = sum(track.observation_count for track in labelled.tracks)
    for row in found["rows"]:
        if row["method"] != "without-tracking" and row["cameras"] == "all":
            assert (row["tp"], row["fp"], row["fn"]) == (observations, 0, 0)
    assert found["tracking"]["hota"] == pytest.approx(1)
    assert found["merges"] == {"right": 1, "wrong": 0, "missed": 0}  # the crossing car
    assert found["without_tracking_from"] == "detections"


def test_the_detections_of_a_run_are_found_again(labelled: LabelledDrive, workspace: Path):
    open_detections = detections_of_result(workspace, labelled.key, CAMERAS)
    assert open_detections is not None
    parts = list(open_detections())
    for number, camera in enumerate(CAMERAS):
        counted = sum(int((part.camera == number).sum()) for part in parts)
        assert counted == labelled.summary["cameras"][camera]["detections"]
    assert all((part.score > 0).all() for part in parts)


def test_detections_that_are_gone_are_not_made_up(labelled: LabelledDrive, workspace: Path, tmp_path: Path):
    assert detections_of_result(workspace, "another", CAMERAS) is None
    assert detections_of_result(tmp_path, labelled.key, CAMERAS) is None
    clip = next((workspace / "artifacts" / "detect").iterdir())
    clip.rename(tmp_path / clip.name)
    assert detections_of_result(workspace, labelled.key, CAMERAS) is None
    (tmp_path / clip.name).rename(clip)
    assert detections_of_result(workspace, labelled.key, CAMERAS) is not None
