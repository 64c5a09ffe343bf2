"""Drives over HTTP."""

import shutil
from pathlib import Path

import pytest

from app.main import create_app
from app.settings import Settings
from tests.app.browser import Browser, browser_on
from tests.app.conftest import Page


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
    assert client.get("/api/models").json() == []
    with browser_on(create_app(settings.model_copy(update={"model": made_model}))) as other:
        assert other.get("/api/models").json() == [{"path": str(made_model), "name": "made", "default": True}]


def test_labelling_is_queued_once(client: Browser, drive_id: int, made_model: Path) -> None:
    request = {"model_path": str(made_model)}
    first = client.post(f"/api/drives/{drive_id}/label", json=request)
    assert (first.status_code, first.json()["state"], first.json()["kind"]) == (202, "queued", "label")
    assert client.post(f"/api/drives/{drive_id}/label", json=request).json() == first.json()
    assert client.get(f"/api/drives/{drive_id}").json()["state"] == "queued"
    client.post(f"/api/jobs/{first.json()['id']}/cancel")
    assert client.get(f"/api/drives/{drive_id}").json()["state"] == "new"


@pytest.mark.parametrize(
    ("request_body", "message"),
    [({}, "No model is configured"), ({"model_path": "/no/model.onnx"}, "no model file /no/model.onnx")],
)
def test_labelling_needs_a_model(client: Browser, drive_id: int, request_body: dict[str, str], message: str) -> None:
    answer = client.post(f"/api/drives/{drive_id}/label", json=request_body)
    assert (answer.status_code, answer.json()["detail"]["code"]) == (422, "unusable_model")
    assert message in answer.json()["detail"]["message"]


def test_a_drive_whose_folder_has_gone_says_so(client: Browser, three_camera_drive: Path, tmp_path: Path) -> None:
    copy = tmp_path / "copy"
    shutil.copytree(three_camera_drive, copy)
    drive_id = client.post("/api/drives", json={"path": str(copy)}).json()["id"]
    shutil.rmtree(copy)
    answer = client.get(f"/api/drives/{drive_id}/frames/0/images/front")
    assert answer.status_code == 404
    assert "Was the drive's folder moved?" in answer.json()["detail"]["message"]
