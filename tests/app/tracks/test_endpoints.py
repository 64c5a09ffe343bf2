"""Tracks and observations over HTTP."""

import pytest

from app.tracks.schemas import ObservationPage
from tests.app.browser import Browser
from tests.app.conftest import Page


def test_tracks(page: Page) -> None:
    tracks = page.get("tracks")
    assert [track["id"] for track in tracks] == [1, 2, 3, 4, 5]
    assert tracks[1] == {
        "id": 2,
        "camera": "left",
        "first_frame": 1,
        "last_frame": 4,
        "observation_count": 4,
        "identity_id": 1,
        "best_score": 0.6,
        "best_frame": 3,
        "class_name": "truck",
    }


def test_an_observation_in_full(page: Page) -> None:
    answer = page.get("observations", start=3, stop=4)
    (frame,) = answer["frames"]
    assert frame["frame_index"] == 3
    filled, truck, _ = frame["observations"]
    donor_id = page.get("observations", start=2, stop=3)["frames"][0]["observations"][0]["id"]
    donor = {"observation_id": donor_id, "camera": "front", "frame_index": 2, "score": 0.9}
    label = {"class_name": "car", "score": 0.9, "source": "propagated", "donor": donor, "withheld": None}
    for one in (filled, truck):
        assert 0 < one["label"].pop("probability") < 1
    assert {key: value for key, value in filled.items() if key != "id"} == {
        "track_id": 1,
        "identity_id": 1,
        "camera": "front",
        "box": [10.0, 10.0, 18.0, 20.0],
        "class_name": "car",
        "score": None,
        "filled": True,
        "trust": 0.95,
        "label": label,
    }
    assert (truck["class_name"], truck["score"], truck["filled"], truck["label"]) == ("truck", 0.6, False, label)


def test_a_donor_names_no_other(page: Page) -> None:
    donor = page.get("observations", start=2, stop=3)["frames"][0]["observations"][0]
    assert donor["label"].pop("probability") > 0
    assert donor["label"] == {
        "class_name": "car",
        "score": 0.9,
        "source": "auto",
        "donor": None,
        "withheld": None,
    }


def test_the_hand_written_json_is_a_page_of_observations(page: Page) -> None:
    answer = page.client.get(f"/api/drives/{page.drive_id}/observations", params={"start": 0, "stop": 6})
    read = ObservationPage.model_validate_json(answer.content)
    assert read.model_dump(mode="json") == answer.json()
    assert sum(len(frame.observations) for frame in read.frames) == 19


@pytest.mark.parametrize(
    ("start", "stop", "frames"),
    [
        (0, 2, [0, 1]),
        (4, 200, [4, 5]),  # the drive ends at 6
        (3, 3, []),
        (50, 60, []),
    ],
)
def test_frames_of_a_page(page: Page, start: int, stop: int, frames: list[int]) -> None:
    answer = page.get("observations", start=start, stop=stop)
    assert [frame["frame_index"] for frame in answer["frames"]] == frames


@pytest.mark.parametrize(("start", "stop"), [(0, 201), (5, 4), (-1, 3)])
def test_pages_that_are_refused(page: Page, start: int, stop: int) -> None:
    answer = page.client.get(f"/api/drives/{page.drive_id}/observations", params={"start": start, "stop": stop})
    assert answer.status_code == 422
    assert answer.json()["detail"]["code"] == "invalid_request"


def test_a_drive_without_labels_has_frames_but_nothing_in_them(client: Browser, drive_id: int) -> None:
    page = Page(client, drive_id)
    answer = page.get("observations", start=0, stop=2)
    assert answer == {"revision": 0, "frames": [{"frame_index": i, "observations": []} for i in (0, 1)]}
    assert (page.get("tracks"), page.get("identities"), page.get("merges")) == ([], [], [])


@pytest.mark.parametrize("what", ["tracks", "identities", "merges", "observations?start=0&stop=1", "jobs"])
def test_no_such_drive(client: Browser, what: str) -> None:
    answer = client.get(f"/api/drives/77/{what}")
    assert answer.status_code == 404
    assert answer.json()["detail"]["message"].startswith("There is no drive 77.")
