"""Evaluation over HTTP, of the labels of tests/app/made_labels.py."""

from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.feather as feather
import pytest

from app.db.session import Store
from app.drives.schemas import DriveRegistration
from app.drives.service import add_local_drive
from app.tracks.importing import import_labelled_drive
from tests.app.browser import Browser
from tests.app.made_labels import PERIOD_NS, START_NS, make_labelled_drive, write_three_camera_drive

# Where tracks 1 and 2 (one identity: car, .9) and track 4 (truck, .5) are, as the truth has it: the first two are one
# car, the third is a truck 90 m away, and there is a car that nobody saw.
TRUTH = (
    *((frame, "front", "car", "CAR", 10.0, 20.0) for frame in range(6)),
    *((frame, "left", "car", "CAR", 20.0, 30.0) for frame in range(1, 5)),
    *((frame, "right", "truck", "TRUCK", 50.0, 90.0) for frame in range(3)),
    (0, "right", "unseen", "CAR", 70.0, 40.0),
)


@pytest.fixture
def with_truth(tmp_path: Path) -> Path:
    """The drive of three cameras, with true boxes."""
    folder = write_three_camera_drive(tmp_path / "with truth")
    columns = {
        "timestamp_ns": [START_NS + row[0] * PERIOD_NS for row in TRUTH],
        "camera": [row[1] for row in TRUTH],
        "track_uuid": [row[2] for row in TRUTH],
        "category": [row[3] for row in TRUTH],
        "x1_px": [row[4] for row in TRUTH],
        "y1_px": [10.0] * len(TRUTH),
        "x2_px": [row[4] + 8 for row in TRUTH],
        "y2_px": [20.0] * len(TRUTH),
        "distance_m": [row[5] for row in TRUTH],
    }
    feather.write_feather(pa.table(columns), str(folder / "annotations_2d.feather"))
    return folder


@pytest.fixture
def evaluated_id(store: Store, with_truth: Path) -> int:
    drive_id = add_local_drive(store, DriveRegistration(path=str(with_truth))).id
    assert import_labelled_drive(store, drive_id, make_labelled_drive(), model_name="made")
    return drive_id


def rows(client: Browser, drive_id: int, **params: Any) -> dict[tuple[str, str], tuple[int, int, int]]:
    """(TP, FP, FN) at an IoU of .5 by method and cameras."""
    answer = client.get(f"/api/drives/{drive_id}/evaluation", params=params)
    assert answer.status_code == 200, answer.text
    return {
        (row["method"], row["cameras"]): (row["tp"], row["fp"], row["fn"])
        for row in answer.json()["rows"]
        if row["iou"] == 0.5
    }


def test_the_table_of_the_stored_labels(client: Browser, evaluated_id: int) -> None:
    assert rows(client, evaluated_id) == {
        ("without-tracking", "all"): (1, 0, 10),  # the one observation of .9
        ("without-tracking", "front"): (1, 0, 5),
        ("single-camera", "all"): (6, 0, 5),  # all of track 1; track 2 alone says truck, .6
        ("single-camera", "front"): (6, 0, 0),
        ("multi-camera", "all"): (10, 0, 1),  # tracks 1 and 2
        ("multi-camera", "front"): (6, 0, 0),
    }


def test_identities_and_what_stands_for_the_detections(client: Browser, evaluated_id: int) -> None:
    found = client.get(f"/api/drives/{evaluated_id}/evaluation").json()
    assert found["merges"] == {"right": 1, "wrong": 0, "missed": 0}
    assert found["tracking"]["id_switches"] == 0
    assert found["without_tracking_from"] == "observations"  # this result was not made by the pipeline
    assert (found["truth_count"], found["dont_care_count"]) == (11, 3)
    assert len(found["by_distance"]) == 3 * 2 * 5
    assert len(found["curves"]) == 3 * 2


def test_a_persons_decision_changes_the_table(client: Browser, evaluated_id: int) -> None:
    (merge,) = (m for m in client.get(f"/api/drives/{evaluated_id}/merges").json() if m["track_b"] == 2)
    assert client.post(f"/api/merges/{merge['id']}/reject").status_code == 200
    assert rows(client, evaluated_id)["multi-camera", "all"] == (6, 0, 5)


def test_settings_are_parameters(client: Browser, evaluated_id: int) -> None:
    # tracks 3 (car .7, four boxes) and 4 (truck .5, three) are sure enough now; 3 lies on nothing, the far truck counts
    assert rows(client, evaluated_id, confidence=0.5, max_distance_m=100)["multi-camera", "all"] == (13, 4, 1)
    answer = client.get(f"/api/drives/{evaluated_id}/evaluation", params={"confidence": 2})
    assert answer.status_code == 422


def test_a_drive_without_truth(client: Browser, labelled_id: int) -> None:
    answer = client.get(f"/api/drives/{labelled_id}/evaluation")
    assert (answer.status_code, answer.json()["detail"]["code"]) == (404, "no_truth")
    assert "has no true boxes" in answer.json()["detail"]["message"]


def test_a_drive_without_labels(client: Browser, drive_id: int) -> None:
    answer = client.get(f"/api/drives/{drive_id}/evaluation")
    assert (answer.status_code, answer.json()["detail"]["code"]) == (409, "conflict")
    assert "Label it first" in answer.json()["detail"]["message"]


def test_no_drive(client: Browser) -> None:
    assert client.get("/api/drives/7/evaluation").json()["detail"]["code"] == "not_found"
