"""Merges over HTTP: what a person's decisions do to identities and labels."""

from itertools import permutations
from typing import Any

import pytest

from app.db.session import Store
from app.merges.schemas import Merge
from app.reviews import repository as reviews
from tests.app.conftest import Page


def test_merges_by_score_with_their_evidence(page: Page) -> None:
    merges = page.get("merges")
    assert [(m["track_a"], m["track_b"], m["score"]) for m in merges] == [
        (1, 2, 0.8),
        (1, 3, 0.5),
        (3, 4, 0.4),
        (2, 4, 0.3),
    ]
    first = merges[0]
    assert (first["camera_a"], first["camera_b"], first["state"], first["decided_by"]) == (
        "front",
        "left",
        "accepted",
        "machine",
    )
    assert (first["identity_a"], first["identity_b"]) == (1, 1)
    assert first["best_frames"] == [{"frame_index": 2, "distance_m": 0.4, "bev_iou": 0.5, "iou_3d": 0.4}]


def test_merges_of_one_state(page: Page) -> None:
    assert [m["track_b"] for m in page.get("merges", state="proposed")] == [3, 4, 4]
    assert page.get("merges", state="rejected") == []


def test_accepting_joins_identities_and_their_labels(page: Page) -> None:
    change = page.decide("accept", 3, 4)
    # the best observation of 3 and 4 is that of 3 in frame 4: car, .7; the three labels of 4 change
    assert (change["changed_label_count"], change["identity_ids"], change["revision"]) == (3, [3], 2)
    assert (change["merge"]["state"], change["merge"]["decided_by"]) == ("accepted", "person")
    assert {key: value for key, value in page.labels().items() if key[0] == 4} == {
        (4, frame): ("car", 0.7, "propagated", 3) for frame in (0, 1, 2)
    }
    (identity,) = (found for found in page.get("identities") if found["id"] == 3)
    assert identity["camera_names"] == ["left", "right"]
    assert (identity["track_ids"], identity["observation_count"], identity["propagated_count"]) == ([3, 4], 7, 6)
    assert (identity["first_frame"], identity["last_frame"], identity["donor"]["frame_index"]) == (0, 5, 4)
    assert [found["id"] for found in page.get("identities")] == [1, 3, 5]


def test_the_answer_holds_all_that_changed(page: Page) -> None:
    seen, identities = _observations(page), {one["id"]: one for one in page.get("identities")}
    decisions = [("accept", 3, 4), ("reject", 1, 2), ("undo", 1, 2), ("undo", 3, 4), ("reject", 1, 2), ("accept", 1, 3)]
    for decision in decisions:
        change = page.decide(*decision)
        patch = {(one["id"]): one for frame in change["observations"] for one in frame["observations"]}
        seen = {key: patch.get(key, one) for key, one in seen.items()}
        assert seen == _observations(page)
        identities |= {one["id"]: one for one in change["identities"]}
        identities = {key: one for key, one in identities.items() if key not in change["gone_identity_ids"]}
        assert identities == {one["id"]: one for one in page.get("identities")}


def test_the_answer_holds_nothing_of_what_did_not_change(page: Page) -> None:
    change = page.decide("accept", 3, 4)
    # labels of 3 keep their class and score, but are more or less likely right now
    assert {one["track_id"] for frame in change["observations"] for one in frame["observations"]} == {3, 4}
    assert ([one["id"] for one in change["identities"]], change["gone_identity_ids"]) == ([3], [4])
    again = page.decide("accept", 3, 4)
    assert (again["observations"], again["identities"], again["revision"]) == ([], [], change["revision"])


def _observations(page: Page) -> dict[int, Any]:
    frames = page.get("observations", start=0, stop=6)["frames"]
    return {one["id"]: one for frame in frames for one in frame["observations"]}


def test_rejecting_a_merge_of_the_machine_splits_its_identity(page: Page) -> None:
    change = page.decide("reject", 1, 2)
    assert (change["changed_label_count"], change["identity_ids"]) == (4, [1, 2])
    labels = page.labels()
    assert labels[2, 3] == ("truck", 0.6, "auto", 2)
    assert labels[2, 1] == ("truck", 0.6, "propagated", 2)
    assert labels[1, 2] == ("car", 0.9, "auto", 1)
    assert [found["id"] for found in page.get("identities")] == [1, 2, 3, 4, 5]


@pytest.mark.parametrize(
    "decisions",
    [
        [("accept", 3, 4)],
        [("reject", 1, 2)],
        [("reject", 1, 2), ("accept", 1, 3), ("accept", 3, 4)],
        [("accept", 2, 4), ("reject", 1, 2)],
    ],
)
def test_undoing_everything_in_any_order_brings_back_what_was(
    page: Page, decisions: list[tuple[str, int, int]]
) -> None:
    before = page.everything()
    for order in permutations(decisions):
        for decision in decisions:
            page.decide(*decision)
        assert page.everything() != before
        for _, track_a, track_b in order:
            page.decide("undo", track_a, track_b)
        assert page.everything() == before
        assert {merge["decided_by"] for merge in page.get("merges")} == {"machine"}


def test_accepting_tracks_that_share_a_frame_is_refused_by_name(page: Page) -> None:
    before = page.everything()
    answer = page.client.post(f"/api/merges/{page.merge(1, 3)['id']}/accept")
    assert answer.status_code == 409
    assert answer.json()["detail"]["code"] == "cannot_link"
    message = answer.json()["detail"]["message"]
    assert "Tracks 1 and 3" in message
    assert "tracks 2 and 3" in message
    assert "camera left in frame 2" in message
    assert page.everything() == before
    page.decide("reject", 1, 2)  # what the message advises
    assert page.decide("accept", 1, 3)["identity_ids"] == [1]


def test_a_merge_of_the_machine_gives_way_to_a_person_and_comes_back(page: Page) -> None:
    page.decide("reject", 1, 2)
    page.decide("accept", 1, 3)
    undone = page.decide("undo", 1, 2)  # the machine would merge them, but 1 is with 3 now, and 2 can't be
    assert (undone["merge"]["state"], undone["merge"]["decided_by"]) == ("proposed", "machine")
    assert undone["identity_ids"] == [1, 2]
    page.decide("undo", 1, 3)
    assert page.merge(1, 2)["state"] == "accepted"


def test_a_merge_that_cannot_be_told_keeps_its_tracks_apart_until_that_is_undone(page: Page) -> None:
    before = page.everything()
    left_open = page.decide("unsure", 3, 4)
    assert (left_open["merge"]["state"], left_open["merge"]["decided_by"]) == ("unsure", "person")
    assert left_open["changed_label_count"] == 0
    assert page.get("merges", state="unsure")[0]["track_b"] == 4
    page.decide("undo", 3, 4)
    assert page.everything() == before
    # one that the machine made comes apart: nobody vouches for it
    assert page.decide("unsure", 1, 2)["identity_ids"] == [1, 2]
    page.decide("undo", 1, 2)
    assert page.everything() == before


def test_a_change_tells_all_merges_that_it_touches(page: Page) -> None:
    change = page.decide("accept", 2, 4)
    # 1, 2 and 4 are one identity now: every merge here has one of them
    assert {(merge["track_a"], merge["track_b"]) for merge in change["merges"]} == {(1, 2), (1, 3), (3, 4), (2, 4)}
    assert {merge["id"]: merge for merge in change["merges"]} == {merge["id"]: merge for merge in page.get("merges")}


def test_the_queue_is_ordered_by_impact_times_uncertainty(page: Page) -> None:
    found = {(merge["track_a"], merge["track_b"]): merge for merge in page.get("merges")}
    assert found[1, 3]["priority"] == 4.0  # 4 labels, score .5: one bit
    assert found[1, 2]["priority"] == pytest.approx(4 * 0.721928, abs=1e-3)  # 4 labels, .8


def test_a_decision_said_twice_is_one(page: Page, store: Store) -> None:
    first = page.decide("accept", 3, 4)
    second = page.decide("accept", 3, 4)
    assert (second["changed_label_count"], second["revision"]) == (0, first["revision"])
    with store.read() as session:
        assert [review.action for review in reviews.list_of_drive(session, page.drive_id)] == ["accept"]


def test_confirming_the_machine_changes_no_label(page: Page) -> None:
    change = page.decide("accept", 1, 2)
    assert (change["changed_label_count"], change["merge"]["decided_by"]) == (0, "person")


def test_every_decision_is_kept(page: Page, store: Store) -> None:
    for verb in ("accept", "reject", "undo"):
        page.decide(verb, 3, 4)
    with store.read() as session:
        kept = reviews.list_of_drive(session, page.drive_id)
    assert [review.action for review in kept] == ["accept", "reject", "undo"]
    assert len({review.subject_id for review in kept}) == 1
    assert {review.reviewer for review in kept} == {"local"}
    # the best observation of track 3, in frame 4
    assert kept[0].anchor_a == {
        "camera": "left",
        "frame_index": 4,
        "timestamp_ns": "1700000000400000000",
        "box": [40.0, 10.0, 48.0, 20.0],
    }


def test_nothing_to_undo(page: Page) -> None:
    answer = page.client.post(f"/api/merges/{page.merge(3, 4)['id']}/undo")
    assert (answer.status_code, answer.json()["detail"]["code"]) == (409, "conflict")


def test_no_such_merge(page: Page) -> None:
    assert page.client.post("/api/merges/999/accept").status_code == 404


def test_label_counts_say_what_a_decision_will_change(page: Page) -> None:
    counts = {(m["track_a"], m["track_b"]): m["label_count"] for m in page.get("merges")}
    # 1-2: the four labels of 2; 1-3: the four of 3; 3-4: the three of 4; 2-4 joins 4 to the identity of 1 and 2
    assert counts == {(1, 2): 4, (1, 3): 4, (3, 4): 3, (2, 4): 3}
    assert page.decide("reject", 1, 2)["changed_label_count"] == 4
    # 2 (best .6) and 4 (best .5) now: still the three of 4
    assert page.merge(2, 4)["label_count"] == page.decide("accept", 2, 4)["changed_label_count"] == 3
    # and undoing that splits 4 off again
    assert page.merge(2, 4)["label_count"] == page.decide("undo", 2, 4)["changed_label_count"] == 3


def test_a_decision_is_refused_where_somebody_changed_one_of_the_objects(page: Page) -> None:
    seen = page.client.get(f"/api/drives/{page.drive_id}").json()["revision"]
    page.decide("accept", 3, 4)
    for verb, track_a, track_b in (("reject", 3, 4), ("undo", 3, 4), ("accept", 2, 4), ("unsure", 1, 3)):
        merge_id = page.merge(track_a, track_b)["id"]
        answer = page.client.post(f"/api/merges/{merge_id}/{verb}", json={"revision": seen})
        assert (answer.status_code, answer.json()["detail"]["code"]) == (409, "stale")
        assert "local changed object #3, #4" in answer.json()["detail"]["message"]
    # objects that nobody touched, and what is said twice, are not in anybody's way
    untouched = page.client.post(f"/api/merges/{page.merge(1, 2)['id']}/accept", json={"revision": seen})
    again = page.client.post(f"/api/merges/{page.merge(3, 4)['id']}/accept", json={"revision": seen})
    assert (untouched.status_code, again.status_code) == (200, 200)


def test_a_decision_about_a_part_of_what_was_split_meanwhile_is_refused(page: Page) -> None:
    seen = page.client.get(f"/api/drives/{page.drive_id}").json()["revision"]
    split = {"edit": {"kind": "split", "track_ids": [1], "frame_index": 2}}
    assert page.client.post(f"/api/drives/{page.drive_id}/edits", json=split).status_code == 200
    (merge,) = (one for one in page.get("merges") if one["score"] == 0.8)  # of 2 and the second part of 1 now
    assert merge["identity_a"] == merge["identity_b"] == 2
    answer = page.client.post(f"/api/merges/{merge['id']}/reject", json={"revision": seen})
    assert (answer.status_code, answer.json()["detail"]["code"]) == (409, "stale")


def test_the_list_is_of_the_form_that_the_api_promises(page: Page) -> None:
    for merge in page.get("merges"):
        assert Merge.model_validate(merge).model_dump(mode="json") == merge


def test_a_score_is_a_probability_only_where_the_evidence_is_calibrated(page: Page) -> None:
    for merge in page.get("merges"):
        calibrated = merge["evidence"] is not None and merge["evidence"]["calibrated"]
        assert merge["probability"] == (merge["score"] if calibrated else None)
