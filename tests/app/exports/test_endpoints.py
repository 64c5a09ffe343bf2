"""Exports over HTTP, made by the real worker."""

import json
import threading
from pathlib import Path

import pytest

from app.db.session import Store
from app.jobs.worker import Worker
from app.settings import Settings
from app.worker import HANDLERS
from tests.app.browser import Browser
from tests.app.conftest import Page


@pytest.fixture
def worker(store: Store, settings: Settings) -> Worker:
    return Worker(store, settings, HANDLERS)


def _export(page: Page, worker: Worker, min_score: float = 0.0) -> dict[str, object]:
    """Ask for an export, have it made, and return what the server says of it."""
    request = {"format": "coco", "min_score": min_score}
    asked = page.client.post(f"/api/drives/{page.drive_id}/exports", json=request)
    assert (asked.status_code, asked.json()["state"], asked.json()["file_url"]) == (202, "queued", None)
    assert worker.run_one(threading.Event())
    return page.client.get(f"/api/exports/{asked.json()['id']}").json()


def test_an_export_from_request_to_file(page: Page, worker: Worker, settings: Settings) -> None:
    export = _export(page, worker)
    assert (export["state"], export["label_count"], export["error"]) == ("done", 19, None)
    answer = page.client.get(str(export["file_url"]))
    assert answer.headers["content-disposition"] == 'attachment; filename="three_cameras-coco-1.json"'
    assert len(answer.content) == export["size_bytes"]
    dataset = answer.json()
    assert len(dataset["images"]) == 18  # 6 frames of 3 cameras, those without labels too
    assert dataset["info"]["drive"] == "three cameras"
    assert dataset["info"]["model"] == "made"
    assert dataset["images"][1] == {
        "id": 2,
        "file_name": "sensors/cameras/left/1700000000000000000.jpg",
        "width": 96,
        "height": 64,
        "camera": "left",
        "frame_index": 0,
        "timestamp_ns": "1700000000000000000",
    }
    (given,) = (a for a in dataset["annotations"] if a["track_id"] == 2 and a["image_id"] == 3 * 3 + 2)
    assert 0 < given["attributes"].pop("probability") < 1
    assert given == {
        "id": given["id"],
        "image_id": 11,
        "category_id": 3,  # car, though the detector said truck
        "bbox": [20.0, 10.0, 8.0, 10.0],
        "area": 80.0,
        "segmentation": [],
        "iscrowd": 0,
        "score": 0.9,
        "track_id": 2,
        "identity_id": 1,
        "attributes": {
            "source": "propagated",
            "filled": False,
            "donor_camera": "front",
            "donor_frame_index": 2,
            "donor_track_id": 1,
            "donor_score": 0.9,
        },
    }
    assert [path.name for path in settings.exports_folder.iterdir()] == ["three_cameras-coco-1.json"]


@pytest.mark.parametrize(
    ("min_score", "count"),
    [
        (0.3, 19),  # all: the lowest label is exactly .3
        (0.31, 17),  # without the two of track 5
        (0.7, 14),  # without the three of track 4 as well; .7 itself stays
        (0.95, 0),
    ],
)
def test_labels_below_the_score_stay_out(page: Page, worker: Worker, min_score: float, count: int) -> None:
    assert _export(page, worker, min_score)["label_count"] == count


def test_an_export_follows_decisions(page: Page, worker: Worker) -> None:
    page.decide("reject", 1, 2)
    dataset = page.client.get(str(_export(page, worker)["file_url"])).json()
    assert {a["category_id"] for a in dataset["annotations"] if a["track_id"] == 2} == {8}  # truck again


def test_the_file_before_it_is_finished(page: Page) -> None:
    asked = page.client.post(f"/api/drives/{page.drive_id}/exports", json={"format": "coco"}).json()
    answer = page.client.get(f"/api/exports/{asked['id']}/file")
    assert (answer.status_code, answer.json()["detail"]["code"]) == (409, "conflict")
    page.client.post(f"/api/jobs/{asked['job_id']}/cancel")
    export = page.client.get(f"/api/exports/{asked['id']}").json()
    assert (export["state"], export["error"]) == ("failed", "It was cancelled.")


def test_a_file_that_was_deleted_is_told(page: Page, worker: Worker, settings: Settings) -> None:
    export = _export(page, worker)
    for path in settings.exports_folder.iterdir():
        path.unlink()
    assert page.client.get(str(export["file_url"])).status_code == 404


def test_an_export_that_fails_says_why(page: Page, worker: Worker, settings: Settings) -> None:
    settings.exports_folder.write_text("a file where the folder should be")
    export = _export(page, worker)
    assert export["state"] == "failed"
    assert "can't be written" in str(export["error"])


@pytest.mark.parametrize("request_body", [{"format": "yolo"}, {"format": "coco", "min_score": 1.1}, {}])
def test_requests_that_are_refused(page: Page, request_body: dict[str, object]) -> None:
    assert page.client.post(f"/api/drives/{page.drive_id}/exports", json=request_body).status_code == 422


def test_there_is_nothing_to_export_before_labelling(client: Browser, drive_id: int) -> None:
    answer = client.post(f"/api/drives/{drive_id}/exports", json={"format": "coco"})
    assert (answer.status_code, answer.json()["detail"]["code"]) == (409, "conflict")


def test_no_such_export(client: Browser) -> None:
    for path in ("/api/exports/5", "/api/exports/5/file"):
        assert client.get(path).status_code == 404


def test_whole_numbers_and_text_survive(page: Page, worker: Worker, tmp_path: Path) -> None:
    content = page.client.get(str(_export(page, worker)["file_url"])).content
    assert all(isinstance(image["timestamp_ns"], str) for image in json.loads(content)["images"])
