"""Whose tracks are they? On a drive made by code, where every answer is known."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from labeler.drive import Drive, open_drive, open_truth
from labeler.drive.types import Truth, TruthBoxes2D
from labeler.evaluation.benchmark_merges import track_scene
from labeler.evaluation.made_observations import NOTHING, Noise, scene_of
from labeler.evaluation.owned_tracks import of_detector, of_scene
from labeler.evaluation.types import EvaluationError
from labeler.pipeline import LabelSettings, label_drive
from labeler.tracking import TrackingConfig
from tests.made_drive import write_drive, write_model

SAMPLE = Path(__file__).parents[3] / "labeler" / "simulation" / "sample" / "turn-at-a-crossing"


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Drive:
    return open_drive(write_drive(tmp_path_factory.mktemp("drive") / "made"))


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_model(tmp_path_factory.mktemp("model") / "made.onnx")


def test_a_track_belongs_to_the_object_that_most_of_its_boxes_show(drive: Drive, model: Path, tmp_path: Path):
    settings = LabelSettings(tracking=TrackingConfig(method="baseline"))
    labelled = label_drive(drive, model=model, workspace=tmp_path, settings=settings)
    whole, unclear, false = sorted(labelled.tracks, key=lambda track: -track.observation_count)[:3]
    # The truth is made of the tracks' own boxes: one object's all along, two objects' by turns, and nobody's.
    rows = [
        (frame.frame_index, camera, "one" if track == whole.track_id else f"turn {frame.frame_index % 2}", box)
        for frame in labelled.frames()
        for camera, view in frame.views.items()
        for track, box in zip(view.observations.track_id.tolist(), view.observations.xyxy_px, strict=True)
        if track in (whole.track_id, unclear.track_id)
    ]
    truth = TruthBoxes2D(
        frame_index=np.array([frame for frame, *_ in rows], np.int32),
        camera=tuple(camera for _, camera, *_ in rows),
        track_uuid=tuple(name for _, _, name, _ in rows),
        category=("CAR",) * len(rows),
        xyxy_px=np.stack([box for *_, box in rows]),
    )

    told = replace(drive, read_truth=lambda _: Truth(boxes_2d=truth, boxes_3d=None))
    owned = of_detector(told, model, workspace=tmp_path, settings=settings)

    assert owned.object_of[whole.track_id] == "one"
    assert unclear.track_id not in owned.object_of
    assert owned.object_of[false.track_id] is None
    assert [frame.frame_index for frame in owned.frames] == [frame.frame_index for frame in labelled.frames()]
    assert any(len(view.positions) for frame in owned.frames for view in frame.views.values())


def test_a_drive_without_truth_is_refused(drive: Drive, model: Path, tmp_path: Path):
    with pytest.raises(EvaluationError, match="nobody knows whose its tracks are"):
        of_detector(drive, model, workspace=tmp_path, settings=LabelSettings())


def test_tracks_of_made_observations_keep_their_objects():
    scene = scene_of(open_truth(SAMPLE), max_frames=8)
    tracked = track_scene(scene, Noise(1.0, 3), TrackingConfig())

    owned = of_scene(tracked)

    for track, owner in tracked.object_of.items():
        assert owned.object_of[track] == (None if owner == NOTHING else str(owner))
