"""What a stored drive shows in 3D; the drive and its labels are those of tests/app/made_labels.py."""

import shutil
from pathlib import Path

import pytest

from app.db.session import Store
from app.drives.schemas import DriveRegistration
from app.drives.service import add_local_drive
from app.errors import NotFound
from app.scene.errors import NoLidar
from app.scene.service import open_stored_source
from app.settings import Settings
from app.tracks.importing import import_labelled_drive
from labeler.identity.types import MergeState
from tests.app.browser import Browser
from tests.app.made_labels import MadeTrack, make_labelled_drive


@pytest.fixture
def flat_id(store: Store, three_camera_drive: Path, tmp_path: Path) -> int:
    """The same drive without its LiDAR."""
    folder = shutil.copytree(three_camera_drive, tmp_path / "flat")
    shutil.rmtree(folder / "sensors" / "lidar")
    return add_local_drive(store, DriveRegistration(path=str(folder))).id


def test_frames_cameras_and_sweeps_come_from_the_files(store: Store, settings: Settings, drive_id: int) -> None:
    source = open_stored_source(store, settings.workspace, drive_id)
    assert source.frame_count == 6
    assert [camera.name for camera in source.cameras] == ["front", "left", "right"]
    sweep = source.sweep(0)
    assert sweep is not None
    assert sweep.xyz_m.tolist() == [[1.0, 1.0, 1.0], [2.0, 2.0, 2.0]]


def test_a_drive_without_labels_has_no_boxes(store: Store, settings: Settings, drive_id: int) -> None:
    assert open_stored_source(store, settings.workspace, drive_id).boxes(0) == []


def test_boxes_carry_identity_class_and_score_of_their_label(
    store: Store, settings: Settings, labelled_id: int
) -> None:
    source = open_stored_source(store, settings.workspace, labelled_id)
    of_track_1, of_no_track = source.boxes(0)
    assert of_track_1.center_m == (12.0, 0.5, 0.75)
    assert of_track_1.size_m == pytest.approx((4.5, 1.8, 1.5))
    assert of_track_1.yaw_rad == 0.25
    assert of_track_1.identity_id == 1
    assert (of_track_1.class_name, of_track_1.score) == ("car", pytest.approx(0.9))  # its best, from frame 2
    assert of_no_track.identity_id is None
    assert (of_no_track.class_name, of_no_track.score) == ("car", pytest.approx(0.8))  # the box's own
    assert source.boxes(3) == []  # track 1 was filled in there: nothing was detected


def test_an_open_view_follows_a_new_labelling(store: Store, settings: Settings, drive_id: int) -> None:
    source = open_stored_source(store, settings.workspace, drive_id)
    tracks = (
        MadeTrack(1, "left", 0, {0: 0.4}),
        MadeTrack(4, "front", 1, {0: 0.5}, box_3d=True),
    )
    labelled = make_labelled_drive(tracks, [(1, 4, 0.9, MergeState.ACCEPTED)], key="second")
    assert import_labelled_drive(store, drive_id, labelled, model_name="made")
    boxes = source.boxes(0)
    assert boxes[0].identity_id == 1  # the smallest track of the two
    assert (boxes[0].class_name, boxes[0].score) == ("truck", pytest.approx(0.5))


def test_no_lidar_and_no_drive_are_said(client: Browser, flat_id: int) -> None:
    answer = client.post(f"/api/drives/{flat_id}/scenes")
    assert answer.status_code == 409
    assert answer.json()["detail"]["code"] == "no_lidar"
    assert "'flat' has no LiDAR" in answer.json()["detail"]["message"]
    answer = client.post("/api/drives/999/scenes")
    assert answer.status_code == 404
    assert answer.json()["detail"]["code"] == "not_found"


def test_errors_of_the_source(store: Store, settings: Settings, flat_id: int) -> None:
    with pytest.raises(NoLidar):
        open_stored_source(store, settings.workspace, flat_id)
    with pytest.raises(NotFound):
        open_stored_source(store, settings.workspace, 999)


def test_the_app_opens_views_and_closes_them_when_it_ends(client: Browser, labelled_id: int) -> None:
    answer = client.post(f"/api/drives/{labelled_id}/scenes", json={"frame_index": 2, "identity_id": 1})
    assert answer.status_code == 201
    page = client.get(answer.json()["url"])
    assert page.status_code == 200
    assert "ws://localhost" in page.headers["content-security-policy"]
    assert client.delete(f"/api/scenes/{answer.json()['scene_id']}").status_code == 204
    assert client.get(answer.json()["url"]).status_code == 404
