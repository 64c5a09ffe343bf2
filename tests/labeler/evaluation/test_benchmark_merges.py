"""On the sample drive that ships: its truth, not its images."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from labeler.drive import open_truth
from labeler.evaluation.benchmark_merges import PairCounts, benchmark_merges, track_scene
from labeler.evaluation.made_observations import NOTHING, Noise, Scene, make_frames, scene_of
from labeler.evaluation.types import EvaluationError
from labeler.identity import SharedFrames
from labeler.tracking import TrackingConfig

SAMPLE = Path(__file__).parents[3] / "labeler" / "simulation" / "sample" / "turn-at-a-crossing"


@pytest.fixture(scope="module")
def scene() -> Scene:
    return scene_of(open_truth(SAMPLE), max_frames=25)


def test_the_same_seed_makes_the_same_and_another_does_not(scene: Scene):
    def scores(seed: int) -> list[float]:
        frames = make_frames(scene, Noise(1.0, seed))
        return [score for frame in frames for made in frame.values() for score in made.detections.score.tolist()]

    assert scores(3) == scores(3)
    assert scores(3) != scores(4)


def test_without_noise_all_that_shows_is_found_where_it_is(scene: Scene):
    for frame in make_frames(scene, Noise(0.0)):
        for made in frame.values():
            place = {number: row for row, number in enumerate(scene.object_id[made.truth.row].tolist())}
            assert NOTHING not in made.object_id
            rows = [place[number] for number in made.object_id.tolist()]
            np.testing.assert_allclose(made.detections.xyxy_px, made.truth.xyxy_px[rows], atol=0.01)
            boxes = made.boxes_3d
            true = made.truth.row[[rows[detection] for detection in boxes.detection_index.tolist()]]
            np.testing.assert_allclose(boxes.center_m, scene.boxes.center_m[true], atol=1e-3)


def test_more_noise_finds_less_and_strays_more(scene: Scene):
    def found(level: float) -> int:
        return sum(
            int((made.object_id >= 0).sum()) for frame in make_frames(scene, Noise(level)) for made in frame.values()
        )

    assert found(0.0) > found(1.0) > found(2.0)


def test_both_methods_are_scored_on_the_same_tracks(scene: Scene):
    found = benchmark_merges(scene, Noise(1.0, 1))
    baseline, ours = found["rows"]
    assert (baseline["method"], ours["method"]) == ("baseline", "ours")
    assert baseline["pairs_right"] + baseline["pairs_missed"] == ours["pairs_right"] + ours["pairs_missed"]
    assert ours["pair_recall"] is not None
    assert baseline["pair_recall"] is not None
    assert ours["pair_recall"] > baseline["pair_recall"]


@pytest.mark.parametrize(
    ("identity_of", "overlapping", "right", "wrong", "missed"),
    [
        ({1: 1, 2: 2, 3: 3, 4: 4, 5: 5}, False, 0, 0, 2),  # 1-3 and 2-3 are one object; 1-2 stand in one image
        ({1: 1, 2: 2, 3: 1, 4: 4, 5: 5}, False, 1, 0, 1),
        ({1: 1, 2: 2, 3: 1, 4: 1, 5: 5}, False, 1, 2, 1),  # 4 is another object: wrong with 1 and with 3
        ({1: 1, 2: 2, 3: 1, 4: 4, 5: 1}, False, 1, 2, 1),  # 5 lies on nothing: wrong with any
        ({1: 1, 2: 2, 3: 1, 4: 1, 5: 5}, True, 1, 1, 1),  # at one time are only 1-3, 2-3 and 3-4
    ],
)
def test_pairs_are_counted_by_what_tracks_are_of(
    scene: Scene, identity_of: dict[int, int], overlapping: bool, right: int, wrong: int, missed: int
):
    shared = SharedFrames()
    shared.add("front", [1, 2])
    tracked = replace(
        track_scene(scene, Noise(0.0), TrackingConfig()),
        object_of={1: 0, 2: 0, 3: 0, 4: 1, 5: NOTHING},
        camera_of={1: "front", 2: "front", 3: "left", 4: "rear", 5: "rear"},
        share_frame=shared,
        frames_of={1: frozenset({1}), 2: frozenset({1}), 3: frozenset({1, 7}), 4: frozenset({7}), 5: frozenset({9})},
    )
    expected = PairCounts(right, wrong, missed)
    assert PairCounts.of(tracked, identity_of, overlapping=overlapping) == expected


def test_a_log_of_annotations_calibration_and_poses_will_do(tmp_path: Path):
    for name in ("annotations.feather", "city_SE3_egovehicle.feather"):
        shutil.copy(SAMPLE / name, tmp_path / name)
    shutil.copytree(SAMPLE / "calibration", tmp_path / "calibration")
    drive = open_truth(tmp_path)
    assert [camera.name for camera in drive.cameras] == ["front", "left", "rear", "right"]
    assert len(drive.frames) == 60
    found = benchmark_merges(scene_of(drive, max_frames=10), Noise(1.0))
    assert found["cameras"] == 4
    assert found["objects"] > 5


def test_a_drive_without_poses_says_so(tmp_path: Path):
    shutil.copy(SAMPLE / "annotations.feather", tmp_path / "annotations.feather")
    shutil.copytree(SAMPLE / "calibration", tmp_path / "calibration")
    with pytest.raises(EvaluationError, match="no poses of the car"):
        scene_of(open_truth(tmp_path))
