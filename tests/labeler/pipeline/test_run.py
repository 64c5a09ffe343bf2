"""Whole runs on the drive made by code, where every answer is known, and on the recorded drives."""

import json
import shutil
from pathlib import Path

import numpy as np
import pyarrow
import pyarrow.feather
import pytest

from labeler.drive import open_drive
from labeler.evaluation.merges import score_merges
from labeler.pipeline import Cancelled, LabelledDrive, LabelSettings, label_drive, open_executor
from labeler.tracking import TrackingConfig


class _Recorder:
    """Counts the units of each stage that had to be done; stops the run after ``stop_after`` of them."""

    def __init__(self, stop_after: int | None = None) -> None:
        self.units: dict[str, int] = {}
        self._left = stop_after

    def stage(self, name: str, units: int) -> None:
        self.units[name] = units

    def advance(self, units: int = 1) -> None:
        if self._left is not None:
            self._left -= units
            if self._left <= 0:
                raise Cancelled("Stopped by the test.")


def _label(
    folder: Path,
    model: Path,
    workspace: Path,
    *,
    settings: LabelSettings | None = None,
    progress: _Recorder | None = None,
) -> LabelledDrive:
    with open_executor("serial") as executor:
        return label_drive(
            open_drive(folder),
            model=model,
            workspace=workspace,
            settings=settings,
            executor=executor,
            progress=progress or _Recorder(),
        )


@pytest.fixture(scope="module")
def labelled(made_drive: Path, made_model: Path, tmp_path_factory: pytest.TempPathFactory) -> LabelledDrive:
    return _label(made_drive, made_model, tmp_path_factory.mktemp("workspace"))


def test_the_summary_has_every_field_and_is_plain_json(labelled: LabelledDrive) -> None:
    summary = json.loads(json.dumps(labelled.summary))
    assert list(summary) == [
        "drive",
        "format",
        "frames",
        "cameras",
        "identities",
        "merges",
        "labels_propagated",
        "seconds",
        "detector_seconds",
        "peak_memory_mb",
        "warnings",
    ]
    assert summary["drive"] == "made drive"
    assert summary["frames"] == 12
    assert [camera["frames"] for camera in summary["cameras"].values()] == [12, 12]
    assert 0 < summary["detector_seconds"] <= summary["seconds"]["detect"]
    assert summary["warnings"] == []


def test_the_car_that_crosses_is_one_identity_and_the_parked_one_another(labelled: LabelledDrive) -> None:
    # Both cameras see the crossing car; the front camera alone sees the parked one.
    accepted = [merge for merge in labelled.merges if merge.state == "accepted"]
    assert [(merge.camera_a, merge.camera_b) for merge in accepted] == [("front", "left")]
    crossing = labelled.identity_of[accepted[0].track_a]
    assert labelled.identity_of[accepted[0].track_b] == crossing == accepted[0].track_a
    assert [track.observation_count for track in labelled.tracks] == [12, 12, 12]
    assert len(set(labelled.identity_of.values())) == 2


def test_every_observation_has_the_label_of_its_donor(labelled: LabelledDrive) -> None:
    rows = propagated = 0
    for frame in labelled.frames():
        for camera, view in frame.views.items():
            for row in range(len(view.observations)):
                donor = labelled.donors[int(view.labels.identity_id[row])]
                assert view.labels.track_id[row] == view.observations.track_id[row]
                assert view.labels.score[row] == pytest.approx(donor.score)
                own = (donor.camera, donor.frame_index, donor.track_id) == (
                    camera,
                    frame.frame_index,
                    view.observations.track_id[row],
                )
                assert bool(view.labels.propagated[row]) is not own
                rows += 1
                propagated += not own
    assert rows == sum(track.observation_count for track in labelled.tracks)
    assert propagated == labelled.summary["labels_propagated"]


def test_a_3d_box_belongs_to_the_track_of_its_detection(labelled: LabelledDrive) -> None:
    merged = {track for merge in labelled.merges for track in (merge.track_a, merge.track_b)}
    (parked,) = (track for track in labelled.tracks if track.track_id not in merged)
    centers = [
        view.boxes_3d.center_m[view.track_of_boxes_3d() == parked.track_id]
        for frame in labelled.frames()
        for camera, view in frame.views.items()
        if camera == "front"
    ]
    found = np.concatenate(centers)
    assert len(found) == 12
    # 12 m away, 20 degrees to the right
    np.testing.assert_allclose(found[:, :2], np.tile([11.28, -4.10], (12, 1)), atol=1.0)


def test_worker_processes_give_the_same_result(
    labelled: LabelledDrive, made_drive: Path, made_model: Path, tmp_path: Path
) -> None:
    with open_executor("processes", workers=2) as executor:
        other = label_drive(open_drive(made_drive), model=made_model, workspace=tmp_path, executor=executor)
    assert other.key == labelled.key
    assert other.tracks == labelled.tracks
    assert other.merges == labelled.merges


def test_a_second_run_has_nothing_to_do(made_drive: Path, made_model: Path, tmp_path: Path) -> None:
    first = _label(made_drive, made_model, tmp_path / "workspace")
    moved = tmp_path / "moved to another place"
    shutil.copytree(made_drive, moved)
    recorder = _Recorder()
    second = _label(moved, made_model, tmp_path / "workspace", progress=recorder)
    stages = ("detect", "lidar", "track", "colours", "identity", "donors", "labels")
    assert recorder.units == dict.fromkeys(stages, 0)
    assert second.key == first.key


def test_a_changed_setting_does_again_only_what_follows(made_drive: Path, made_model: Path, tmp_path: Path) -> None:
    first = _label(made_drive, made_model, tmp_path)
    recorder = _Recorder()
    settings = LabelSettings(tracking=TrackingConfig(birth_score=0.97))
    second = _label(made_drive, made_model, tmp_path, settings=settings, progress=recorder)
    assert recorder.units == {
        "detect": 0,
        "lidar": 0,
        "track": 2,
        "colours": 2,
        "identity": 1,
        "donors": 1,
        "labels": 2,
    }
    assert second.key != first.key


_WITHOUT_MOTION = tuple(
    LabelSettings(tracking=one) for one in (TrackingConfig(ego_motion="none"), TrackingConfig(method="baseline"))
)


def test_the_cars_motion_takes_part_in_tracking_unless_it_is_not_asked_for(
    made_drive: Path, made_model: Path, tmp_path: Path
) -> None:
    """Mended poses track again, but not for a tracker that takes none of them."""
    folder = tmp_path / "drive"
    shutil.copytree(made_drive, folder)
    for settings in (LabelSettings(), *_WITHOUT_MOTION):
        _label(folder, made_model, tmp_path / "workspace", settings=settings)
    poses = pyarrow.feather.read_table(folder / "city_SE3_egovehicle.feather")
    east_m = pyarrow.array(np.arange(poses.num_rows) * 0.1)
    poses = poses.set_column(poses.column_names.index("tx_m"), "tx_m", east_m)
    pyarrow.feather.write_feather(poses, folder / "city_SE3_egovehicle.feather")
    for settings, cameras in ((LabelSettings(), 2), *((one, 0) for one in _WITHOUT_MOTION)):
        again = _Recorder()
        _label(folder, made_model, tmp_path / "workspace", settings=settings, progress=again)
        assert again.units["track"] == cameras


@pytest.mark.parametrize("stop_after", [1, 13, 24, 26, 28])
def test_a_stopped_run_resumes_to_the_same_result(
    stop_after: int, labelled: LabelledDrive, made_drive: Path, made_model: Path, tmp_path: Path
) -> None:
    with pytest.raises(Cancelled):
        _label(made_drive, made_model, tmp_path, progress=_Recorder(stop_after))
    assert not list(tmp_path.rglob("*.tmp"))
    resumed = _label(made_drive, made_model, tmp_path)
    assert (resumed.key, resumed.tracks, resumed.merges) == (labelled.key, labelled.tracks, labelled.merges)


def test_files_that_cannot_be_read_are_named_and_skipped(made_drive: Path, made_model: Path, tmp_path: Path) -> None:
    broken = tmp_path / "broken"
    shutil.copytree(made_drive, broken)
    image = sorted((broken / "sensors" / "cameras" / "front").iterdir())[10]
    sweep = sorted((broken / "sensors" / "lidar").iterdir())[11]
    for file in (image, sweep):
        file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    for attempt in ("first", "from artifacts"):
        result = _label(broken, made_model, tmp_path / "workspace")
        assert result.summary["cameras"]["front"]["frames"] == 11, attempt
        assert result.summary["merges"]["accepted"] == 1, attempt
        warnings = "\n".join(result.summary["warnings"])
        assert image.name in warnings, attempt
        assert sweep.name in warnings, attempt


def test_without_lidar_places_are_guessed_from_heights_and_the_summary_says_so(
    made_drive: Path, made_model: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "no lidar"
    shutil.copytree(made_drive, folder)
    shutil.rmtree(folder / "sensors" / "lidar")
    result = _label(folder, made_model, tmp_path / "workspace")
    assert all(merge.mean_bev_iou in (None, 0) for merge in result.merges)  # no 3D boxes to overlap
    assert result.summary["labels_propagated"] > 0
    assert any("no LiDAR" in warning for warning in result.summary["warnings"])


@pytest.mark.real_drive
def test_tri_scene_01_has_tracks_in_all_cameras_and_merges_that_agree_with_the_truth(
    tri_scene_01: Path, yolox_nano_dynamic: Path, tmp_path: Path
) -> None:
    result = _label(tri_scene_01, yolox_nano_dynamic, tmp_path)
    assert len(result.summary["cameras"]) == 3
    assert all(camera["tracks"] > 0 for camera in result.summary["cameras"].values())
    pairs = {(merge.camera_a, merge.camera_b) for merge in result.merges if merge.state == "accepted"}
    assert ("ring_front_center", "ring_front_left") in pairs
    drive = open_drive(tri_scene_01)
    truth = drive.read_truth(drive.frames)
    assert truth is not None
    assert truth.boxes_2d is not None
    observations = {camera.name: result.observations(camera.name) for camera in drive.cameras}
    score = score_merges(truth.boxes_2d, observations, result.identity_of, min_iou=0.3)  # the true boxes are loose
    assert (score.vehicles, score.found, score.wrong_merges) == (13, 3, 0)
    assert score.not_tracked == 10  # all that could be found were


@pytest.mark.real_drive
def test_kitti_0052_runs_through_without_poses(kitti_0052: Path, yolox_nano_dynamic: Path, tmp_path: Path) -> None:
    result = _label(kitti_0052, yolox_nano_dynamic, tmp_path)
    assert result.summary["frames"] == 40
    assert sum(len(view.boxes_3d) for frame in result.frames() for view in frame.views.values()) > 40


@pytest.mark.real_drive
def test_nuscenes_one_sample_runs_through(nuscenes_one_sample: Path, yolox_nano_dynamic: Path, tmp_path: Path) -> None:
    result = _label(nuscenes_one_sample, yolox_nano_dynamic, tmp_path)
    assert result.summary["frames"] == 1
    assert len(result.summary["cameras"]) == 6
    assert all(track.observation_count == 1 for track in result.tracks)
