"""The user's way through the interface with the real pipeline: upload, label, decide, label again, export."""

import io
import threading
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from app.db.session import Store
from app.jobs.worker import Worker
from app.main import create_app
from app.settings import Settings
from app.worker import HANDLERS
from tests.app.browser import Browser, browser_on
from tests.app.conftest import Page


def _packed(folder: Path) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for path in sorted(folder.rglob("*")):
            archive.write(path, Path(folder.name) / path.relative_to(folder))
    return packed.getvalue()


def _upload_and_label(client: Browser, work: Callable[[], object], folder: Path) -> Page:
    drive = client.post("/api/drives/upload", params={"filename": "drive.zip"}, content=_packed(folder)).json()
    assert drive["state"] == "queued"
    work()
    drive = client.get(f"/api/drives/{drive['id']}").json()
    assert (drive["state"], drive["error"]) == ("ready", None)
    return Page(client, drive["id"])


def _export(page: Page, work: Callable[[], object]) -> Any:
    asked = page.client.post(f"/api/drives/{page.drive_id}/exports", json={"format": "coco"}).json()
    work()
    export = page.client.get(f"/api/exports/{asked['id']}").json()
    dataset = page.client.get(export["file_url"]).json()
    assert len(dataset["annotations"]) == export["label_count"]
    return dataset


def _accept_reject_undo(page: Page) -> None:
    """Each decision about the first merge changes what it should, and undoing it brings back what was."""
    merge = page.get("merges")[0]
    pair = (merge["track_a"], merge["track_b"])
    before = page.everything()
    rejected = page.decide("reject", *pair)
    assert rejected["merge"]["identity_a"] != rejected["merge"]["identity_b"]
    accepted = page.decide("accept", *pair)
    assert accepted["merge"]["identity_a"] == accepted["merge"]["identity_b"]
    assert accepted["changed_label_count"] == rejected["changed_label_count"] > 0
    page.decide("undo", *pair)
    assert page.everything() == before


def test_a_made_drive(settings: Settings, store: Store, made_drive: Path, made_model: Path) -> None:
    with_model = settings.model_copy(update={"model": str(made_model)})
    worker = Worker(store, with_model, HANDLERS)

    def work() -> None:
        assert worker.run_one(threading.Event())

    with browser_on(create_app(with_model)) as client:
        page = _upload_and_label(client, work, made_drive)
        (merge,) = page.get("merges", state="accepted")  # the car that crosses from front to left
        assert {merge["camera_a"], merge["camera_b"]} == {"front", "left"}
        _accept_reject_undo(page)
        page.decide("reject", merge["track_a"], merge["track_b"])

        again = client.post(f"/api/drives/{page.drive_id}/label", json={}).json()
        work()  # resumes from the artifacts of the first run, under what was decided since
        assert client.get(f"/api/jobs/{again['id']}").json()["message"] is None
        decided = page.merge(merge["track_a"], merge["track_b"])
        assert (decided["state"], decided["decided_by"]) == ("rejected", "person")

        again = client.post(f"/api/drives/{page.drive_id}/label", json={}).json()
        work()
        assert client.get(f"/api/jobs/{again['id']}").json()["message"].startswith("Nothing has changed")

        page.decide("undo", merge["track_a"], merge["track_b"])
        assert page.merge(merge["track_a"], merge["track_b"])["state"] == "accepted"  # the machine's own word
        page.decide("reject", merge["track_a"], merge["track_b"])

        dataset = _export(page, work)
    identity_of = {label["track_id"]: label["identity_id"] for label in dataset["annotations"]}
    assert identity_of[merge["track_a"]] != identity_of[merge["track_b"]]


@pytest.mark.real_drive
def test_a_real_drive(settings: Settings, store: Store, tri_scene_01: Path, yolox_nano_dynamic: Path) -> None:
    with_model = settings.model_copy(update={"model": str(yolox_nano_dynamic)})
    worker = Worker(store, with_model, HANDLERS)

    def work() -> None:
        assert worker.run_one(threading.Event())

    with browser_on(create_app(with_model)) as client:
        page = _upload_and_label(client, work, tri_scene_01)
        assert {track["camera"] for track in page.get("tracks")} == {
            "ring_front_center",
            "ring_front_left",
            "ring_front_right",
        }
        _accept_reject_undo(page)
        dataset = _export(page, work)
    assert len(dataset["images"]) == 9
    assert all((tri_scene_01 / image["file_name"]).is_file() for image in dataset["images"])
