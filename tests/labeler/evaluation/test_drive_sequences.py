"""The drive that ships, camera by camera: a turn at a crossing, where it counts that the car's motion is known."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from labeler.detection import DetectionConfig
from labeler.drive import open_drive
from labeler.evaluation.drive_sequences import sequences_of_drive
from labeler.evaluation.label_benchmark import benchmark_labels
from labeler.evaluation.sequences import DetectedSequence
from labeler.evaluation.types import EvaluationConfig, EvaluationError
from labeler.pipeline import SilentProgress
from labeler.tracking import TrackingConfig

LABELER = Path(__file__).parents[3] / "labeler"
SAMPLE = LABELER / "simulation" / "sample" / "turn-at-a-crossing"
WEIGHTS = LABELER / "models" / "weights" / "sim-yolox-nano.onnx"


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("workspace")


def sequences(folder: Path, workspace: Path, *cameras: str, model: Path = WEIGHTS) -> Iterator[DetectedSequence]:
    """Every second frame."""
    return sequences_of_drive(
        open_drive(folder),
        model=model,
        workspace=workspace,
        detection=DetectionConfig(),
        config=EvaluationConfig(),
        progress=SilentProgress(),
        cameras=cameras,
        every=2,
    )


def test_frames_and_truth_of_one_camera(workspace: Path) -> None:
    (left,) = sequences(SAMPLE, workspace, "left")
    assert left.name == "turn-at-a-crossing, left"
    assert [frame.frame_index for frame in left.frames] == list(range(0, 60, 2))
    drive = open_drive(SAMPLE)
    truth = drive.read_truth(drive.frames)
    assert truth is not None
    boxes = truth.boxes_2d
    assert boxes is not None
    rows = [row for row, camera in enumerate(boxes.camera) if camera == "left" and boxes.frame_index[row] % 2 == 0]
    assert len(left.truth) == len(rows) > 100
    assert set(left.truth.image.tolist()) == set(boxes.frame_index[rows].tolist())
    motion = left.motion_of(TrackingConfig())
    assert motion is not None
    assert motion.timestamp_ns.tolist() == [frame.timestamp_ns for frame in left.frames]
    assert np.isfinite(motion.city_SE3_camera).all()


@pytest.mark.parametrize("config", [TrackingConfig(ego_motion="none"), TrackingConfig(method="baseline")])
def test_who_takes_no_motion_is_given_none(config: TrackingConfig, workspace: Path) -> None:
    (left,) = sequences(SAMPLE, workspace, "left")
    assert left.motion_of(config) is None


def test_turns_alone_are_those_of_what_is_far_away(workspace: Path) -> None:
    (left,) = sequences(SAMPLE, workspace, "left")
    motion = left.motion_of(TrackingConfig(ego_motion="rotation"))
    assert motion is not None
    assert np.isinf(motion.usual_height_m).all()


def test_a_car_that_turns_breaks_fewer_tracks_when_it_is_known(workspace: Path) -> None:
    rows = benchmark_labels(sequences(SAMPLE, workspace, "left", "rear"), ego_motions=True)
    assert [row["method"] for row in rows] == [
        "none",
        "baseline",
        "ours",
        "without ego motion",
        "the car's turns alone",
    ]
    figures = [(row["hota"], row["identities_per_object"]) for row in rows[2:]]
    hota, identities = np.array(figures, np.float64).T  # ours, without, turns alone
    assert (hota[[0, 2]] > hota[1] + 0.03).all()
    assert (identities[[0, 2]] < 0.8 * identities[1]).all()
    assert identities[1] > 1


def test_what_cannot_be_measured_says_so(made_drive: Path, made_model: Path, workspace: Path) -> None:
    with pytest.raises(EvaluationError, match="made drive has no true boxes"):
        next(sequences(made_drive, workspace, model=made_model))
    with pytest.raises(EvaluationError, match=r"has no camera roof\. It has front, left, rear, right"):
        next(sequences(SAMPLE, workspace, "roof"))
