"""Drives over HTTP."""

import shutil
from pathlib import Path

import pytest

from app.db.session import Store
from app.main import create_app
from app.settings import Settings
from app.tracks.importing import import_labelled_drive
from tests.app.browser import Browser, browser_on
from tests.app.conftest import Page
from tests.app.made_labels import make_labelled_drive


def test_registering_a_folder(client: Browser, three_camera_drive: Path) -> None:
    answer = client.post("/api/drives", json={"path": str(three_camera_drive)})
    assert answer.status_code == 201, answer.text
    drive = answer.json()
    assert (drive["name"], drive["format"], drive["state"]) == ("three cameras", "argoverse2", "new")
    assert (drive["uploaded"], drive["has_poses"], drive["error"]) == (False, False, None)
    detail = client.get(f"/api/drives/{drive['id']}").json()
    assert detail["frame_times_ms"] == [0.0, 100.0, 200.0, 300.0, 400.0, 500.0]
    assert detail["cameras"][1] == {"name": "left", "width_px": 96, "height_px": 64, "has_calibration": True}
    assert (detail["class_names"], detail["revision"], detail["summary"]) == ([], 0, None)
    assert any("city_SE3_egovehicle" in warning for warning in detail["warnings"])


def test_a_folder_that_is_known_is_answered_again(client: Browser, three_camera_drive: Path) -> None:
    first = client.post("/api/drives", json={"path": str(three_camera_drive)}).json()
    assert client.post("/api/drives", json={"path": f"{three_camera_drive}/../three cameras"}).json() == first
    assert [drive["id"] for drive in client.get("/api/drives").json()] == [first["id"]]


def test_a_labelled_drive(page: Page) -> None:
    (drive,) = page.client.get("/api/drives").json()
    assert drive["state"] == "ready"
    assert (drive["identity_count"], drive["track_count"], drive["observation_count"]) == (4, 5, 19)
    assert drive["proposed_merge_count"] == 3
    detail = page.client.get(f"/api/drives/{page.drive_id}").json()
    assert detail["class_names"] == ["car", "truck", "cone"]
    assert detail["summary"]["detector_seconds"] == 0.5
    assert "a sweep was skipped" in detail["warnings"]


def test_deleting_a_registered_drive_leaves_its_folder(page: Page, three_camera_drive: Path) -> None:
    page.decide("accept", 3, 4)
    files = sorted(three_camera_drive.rglob("*"))
    assert page.client.delete(f"/api/drives/{page.drive_id}").status_code == 204
    assert page.client.get("/api/drives").json() == []
    assert sorted(three_camera_drive.rglob("*")) == files
    assert page.client.delete(f"/api/drives/{page.drive_id}").status_code == 404


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("/no/such/folder", "does not exist"),
        ("relative/folder", "whole path"),
        ("~nobody-of-that-name/x", "whole path"),
    ],
)
def test_folders_that_are_no_drive(client: Browser, path: str, message: str) -> None:
    answer = client.post("/api/drives", json={"path": path})
    assert (answer.status_code, answer.json()["detail"]["code"]) == (422, "unusable_drive")
    assert message in answer.json()["detail"]["message"]


@pytest.mark.parametrize(("allow", "status"), [(False, 403), (True, 201)])
def test_a_server_that_others_reach_takes_no_paths_unless_told(
    settings: Settings, three_camera_drive: Path, allow: bool, status: int
) -> None:
    public = settings.model_copy(update={"host": "0.0.0.0", "allow_local_paths": allow})
    with browser_on(create_app(public)) as client:
        assert client.post("/api/drives", json={"path": str(three_camera_drive)}).status_code == status


def test_models(settings: Settings, client: Browser, made_model: Path) -> None:
    (shipped,) = client.get("/api/models").json()
    assert (shipped["name"], shipped["named"]) == ("sim-yolox-nano", "sim-yolox-nano")
    assert (shipped["origin"], shipped["default"]) == ("shipped", True)
    assert "hindsight models pull yolox-x" in shipped["notice"]
    settings.model_cache.add(made_model, "mine")
    assert [(model["name"], model["default"]) for model in client.get("/api/models").json()] == [
        ("sim-yolox-nano", True),
        ("mine", False),
    ]


def test_the_model_of_the_settings_is_offered_first(settings: Settings, made_model: Path) -> None:
    with browser_on(create_app(settings.model_copy(update={"model": str(made_model)}))) as client:
        first, shipped = client.get("/api/models").json()
    assert first == {"name": "made", "named": str(made_model), "origin": "file", "default": True, "notice": None}
    assert (shipped["name"], shipped["default"]) == ("sim-yolox-nano", False)


def test_a_setting_that_names_no_model_says_so(settings: Settings, drive_id: int) -> None:
    with browser_on(create_app(settings.model_copy(update={"model": "yolox-s"}))) as client:
        for answer in (client.get("/api/models"), client.post(f"/api/drives/{drive_id}/label", json={})):
            assert (answer.status_code, answer.json()["detail"]["code"]) == (422, "unusable_model")
            assert "hindsight models pull yolox-s" in answer.json()["detail"]["message"]


def test_a_drive_says_which_model_made_its_labels(page: Page) -> None:
    drive = page.client.get(f"/api/drives/{page.drive_id}").json()
    assert (drive["model"], drive["notice"], drive["is_simulated"]) == ("made", None, False)


def test_labels_of_the_shipped_model_come_with_a_notice(client: Browser, store: Store, drive_id: int) -> None:
    import_labelled_drive(store, drive_id, make_labelled_drive(), model_name="sim-yolox-nano")
    drive = client.get(f"/api/drives/{drive_id}").json()
    assert drive["notice"] == drive["warnings"][0]
    assert "trained on simulated drives" in drive["notice"]


def test_simulated_drives_are_known_and_need_no_notice(
    client: Browser, store: Store, three_camera_drive: Path, tmp_path: Path
) -> None:
    folder = shutil.copytree(three_camera_drive, tmp_path / "simulated")
    (folder / "simulation.json").write_text("{}")
    drive_id = client.post("/api/drives", json={"path": str(folder)}).json()["id"]
    import_labelled_drive(store, drive_id, make_labelled_drive(), model_name="sim-yolox-nano")
    drive = client.get(f"/api/drives/{drive_id}").json()
    assert (drive["is_simulated"], drive["notice"]) == (True, None)


def test_labelling_is_queued_once(client: Browser, drive_id: int, made_model: Path) -> None:
    request = {"model": str(made_model)}
    first = client.post(f"/api/drives/{drive_id}/label", json=request)
    assert (first.status_code, first.json()["state"], first.json()["kind"]) == (202, "queued", "label")
    assert first.json()["model"] == "made"
    assert client.post(f"/api/drives/{drive_id}/label", json=request).json() == first.json()
    assert client.get(f"/api/drives/{drive_id}").json()["state"] == "queued"
    client.post(f"/api/jobs/{first.json()['id']}/cancel")
    assert client.get(f"/api/drives/{drive_id}").json()["state"] == "new"


@pytest.mark.parametrize(
    ("request_body", "message"),
    [
        ({"model": "/no/model.onnx"}, "no model file /no/model.onnx"),
        ({"model": "yolox-x"}, "hindsight models pull yolox-x"),
        ({"model": "yolo"}, "There is no detection model yolo"),
    ],
)
def test_labelling_needs_a_model_that_is_there(
    client: Browser, drive_id: int, request_body: dict[str, str], message: str
) -> None:
    answer = client.post(f"/api/drives/{drive_id}/label", json=request_body)
    assert (answer.status_code, answer.json()["detail"]["code"]) == (422, "unusable_model")
    assert message in answer.json()["detail"]["message"]


@pytest.mark.parametrize(("allow", "status"), [(False, 403), (True, 202)])
def test_a_server_that_others_reach_takes_no_files_unless_told(
    settings: Settings, drive_id: int, made_model: Path, allow: bool, status: int
) -> None:
    settings.model_cache.add(made_model, "mine")
    public = settings.model_copy(update={"host": "0.0.0.0", "allow_local_paths": allow})
    with browser_on(create_app(public)) as client:
        answer = client.post(f"/api/drives/{drive_id}/label", json={"model": str(made_model)})
        assert answer.status_code == status
        by_name = client.post(f"/api/drives/{drive_id}/label", json={"model": "mine"})
        assert by_name.status_code == 202  # one that the server offers is always allowed


def test_a_drive_whose_folder_has_gone_says_so(client: Browser, three_camera_drive: Path, tmp_path: Path) -> None:
    copy = tmp_path / "copy"
    shutil.copytree(three_camera_drive, copy)
    drive_id = client.post("/api/drives", json={"path": str(copy)}).json()["id"]
    shutil.rmtree(copy)
    answer = client.get(f"/api/drives/{drive_id}/frames/0/images/front")
    assert answer.status_code == 404
    assert "Was the drive's folder moved?" in answer.json()["detail"]["message"]
