"""What there is to see of a merge, over HTTP."""

from typing import Any

import pytest

from app.db.session import Store
from app.tracks.importing import import_labelled_drive
from labeler.identity.types import MergeState
from tests.app.conftest import Page
from tests.app.made_labels import MadeTrack, make_labelled_drive


def _looks(page: Page, track_a: int, track_b: int) -> dict[str, Any]:
    answer = page.client.get(f"/api/merges/{page.merge(track_a, track_b)['id']}/looks")
    assert answer.status_code == 200, answer.text
    return answer.json()


def _places(looks: list[dict[str, Any]]) -> list[tuple[int, int]]:
    return [(look["track_id"], look["frame_index"]) for look in looks]


def test_both_tracks_at_their_best_and_at_the_shared_moment(page: Page) -> None:
    looks = _looks(page, 1, 2)
    a, b = looks["sides"]
    assert a["best"] == {
        "track_id": 1,
        "identity_id": 1,
        "camera": "front",
        "frame_index": 2,
        "box": [10.0, 10.0, 18.0, 20.0],
        "class_name": "car",
        "score": 0.9,
    }
    assert (b["camera"], b["class_name"], b["best"]["frame_index"], b["first_frame"], b["last_frame"]) == (
        "left",
        "truck",
        3,
        1,
        4,
    )
    # the frame that the machine named as its best evidence; track 2 has no 3D box to measure to
    assert [_places(moment["looks"]) for moment in looks["moments"]] == [[(1, 2), (2, 2)]]
    assert looks["moments"][0]["distance_m"] is None


def test_ways_without_poses_are_relative_to_the_car(page: Page) -> None:
    looks = _looks(page, 1, 2)
    assert looks["frame"] == "ego"
    assert looks["ego"]["frame_index"] == []
    way = looks["sides"][0]["way"]
    assert (way["frame_index"], way["x_m"][0], way["y_m"][0], way["length_m"][0]) == ([0, 1, 2, 4, 5], 12.0, 0.5, 4.5)
    assert looks["sides"][1]["way"]["frame_index"] == []


def test_the_strip_holds_all_tracks_of_both_identities_in_order_of_time(page: Page) -> None:
    # 1 and 2 are one identity, so the strip of 2-4 holds all three; filled-in frame 3 of track 1 has no score
    strip = _looks(page, 2, 4)["strip"]
    assert _places(strip)[:5] == [(1, 0), (4, 0), (1, 1), (2, 1), (4, 1)]
    assert {look["track_id"] for look in strip} == {1, 2, 4}
    assert [look["score"] for look in strip if look["track_id"] == 1][3] is None


@pytest.mark.parametrize(
    ("frames_a", "frames_b", "moment"),
    [
        ((0, 1, 2), (4, 5), (2, 4)),  # the one ends before the other begins
        ((4, 5), (0, 1), (4, 1)),  # the other way round
        ((0, 2, 4), (3, 5), (2, 3)),  # in turn: the first of those that are one frame apart
    ],
)
def test_tracks_that_share_no_frame_are_shown_where_they_come_closest(
    store: Store, page: Page, frames_a: tuple[int, ...], frames_b: tuple[int, ...], moment: tuple[int, int]
) -> None:
    tracks = (
        MadeTrack(1, "front", 0, dict.fromkeys(frames_a, 0.5)),
        MadeTrack(2, "left", 0, dict.fromkeys(frames_b, 0.5)),
    )
    labelled = make_labelled_drive(tracks, [(1, 2, 0.5, MergeState.PROPOSED)], key="apart")
    import_labelled_drive(store, page.drive_id, labelled, model_name="made")
    (shown,) = _looks(page, 1, 2)["moments"]
    assert tuple(look["frame_index"] for look in shown["looks"]) == moment


def test_no_such_merge(page: Page) -> None:
    assert page.client.get("/api/merges/999/looks").status_code == 404
