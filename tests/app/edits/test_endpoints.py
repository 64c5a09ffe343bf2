"""Corrections over HTTP: each kind of edit, what is refused, and the log."""

from typing import Any

import pytest

from app.db.session import Store
from app.tracks.models import LabellingRow
from tests.app.conftest import Page
from tests.app.edits.conftest import Editor


def test_a_class_that_a_person_sets_wins(editor: Editor, page: Page) -> None:
    change = editor.edit("class", identity_ids=[1], class_name="truck")
    # all ten labels of tracks 1 and 2
    assert (change["changed_label_count"], change["identity_ids"]) == (10, [1])
    assert {label for (track, _), label in page.labels().items() if track in (1, 2)} == {("truck", 1.0, "human", 1)}
    identity = editor.identity(1)
    assert (identity["class_name"], identity["score"], identity["class_by_person"]) == ("truck", 1.0, True)
    assert identity["propagated_count"] == 0


def test_a_class_stays_with_the_object_that_the_person_saw(editor: Editor, page: Page) -> None:
    editor.edit("class", identity_ids=[1], class_name="truck")
    page.decide("reject", 1, 2)
    # the best observation of the object was that of track 1; 2 takes the machine's word again
    assert editor.identity(1)["class_name"] == "truck"
    assert page.labels()[2, 3] == ("truck", 0.6, "auto", 2)
    assert not editor.identity(2)["class_by_person"]


def test_a_split_track_is_two_objects(editor: Editor, page: Page) -> None:
    change = editor.edit("split", track_ids=[1], frame_index=3)
    # the claim that 1 and 2 are one is about frame 2, so the first part stays with 2
    assert change["identity_ids"] == [1, 6]
    assert editor.identity(1)["track_ids"] == [1, 2]
    second = editor.identity(6)
    assert (second["first_frame"], second["last_frame"], second["score"]) == (3, 5, 0.6)
    assert page.labels()[1, 2] == ("car", 0.9, "auto", 1)
    assert page.labels()[6, 5] == ("car", 0.6, "propagated", 6)
    tracks = {track["id"]: track for track in page.get("tracks")}
    assert (tracks[1]["last_frame"], tracks[1]["observation_count"], tracks[1]["best_frame"]) == (2, 3, 2)
    assert (tracks[6]["first_frame"], tracks[6]["observation_count"], tracks[6]["camera"]) == (3, 3, "front")


def test_the_merge_follows_the_part_that_its_evidence_is_about(editor: Editor, page: Page) -> None:
    editor.edit("split", track_ids=[1], frame_index=2)
    (merge,) = (one for one in page.get("merges") if one["state"] == "accepted")
    assert {merge["track_a"], merge["track_b"]} == {6, 2}
    assert editor.identity(2)["track_ids"] == [2, 6]


def test_3d_boxes_follow_their_track(editor: Editor, store: Store) -> None:
    editor.edit("split", track_ids=[1], frame_index=4)
    assert editor.boxes_3d() == {(0, 1), (1, 1), (2, 1), (4, 6), (5, 6)}
    editor.edit("delete", track_ids=[6])
    assert editor.boxes_3d() == {(0, 1), (1, 1), (2, 1)}


@pytest.mark.parametrize("frame_index", [0, 6])
def test_a_track_is_split_only_where_both_parts_have_a_frame(editor: Editor, frame_index: int) -> None:
    answer = editor.refused("split", track_ids=[1], frame_index=frame_index)
    assert (answer.status_code, answer.json()["detail"]["code"]) == (422, "invalid_request")
    assert "from frame 0 to 5" in answer.json()["detail"]["message"]


def test_the_second_of_two_splits_outlives_the_first(editor: Editor, page: Page) -> None:
    first = editor.edit("split", track_ids=[1], frame_index=2)
    editor.edit("split", track_ids=[6], frame_index=4)
    assert [(t["id"], t["first_frame"], t["last_frame"]) for t in editor.tracks_in("front")] == [
        (1, 0, 1),
        (5, 0, 1),
        (6, 2, 3),
        (7, 4, 5),
    ]
    editor.undo(first["edit"]["id"])
    assert [(t["id"], t["first_frame"], t["last_frame"]) for t in editor.tracks_in("front")] == [
        (1, 0, 3),
        (5, 0, 1),
        (7, 4, 5),
    ]
    assert editor.redo(first["edit"]["id"])["edit"]["undone"] is False
    assert [t["id"] for t in editor.tracks_in("front")] == [1, 5, 6, 7]


def test_joined_objects_are_one(editor: Editor, page: Page) -> None:
    change = editor.edit("join", identity_ids=[3, 4])
    # the best of both is track 3, frame 4: car, .7; the three labels of 4 change
    assert (change["changed_label_count"], change["identity_ids"]) == (3, [3])
    assert page.labels()[4, 0] == ("car", 0.7, "propagated", 3)


def test_objects_in_one_image_are_not_joined(editor: Editor, page: Page) -> None:
    before = page.everything()
    answer = editor.refused("join", identity_ids=[1, 3])
    assert (answer.status_code, answer.json()["detail"]["code"]) == (409, "cannot_link")
    assert "tracks 2 and 3" in answer.json()["detail"]["message"]
    assert "camera left in frame 2" in answer.json()["detail"]["message"]
    assert page.everything() == before
    assert editor.log()["edits"] == []


def test_a_person_may_join_again_what_a_person_split(editor: Editor) -> None:
    editor.edit("split", track_ids=[1], frame_index=3)
    assert editor.edit("join", identity_ids=[1, 6])["identity_ids"] == [1]
    assert editor.identity(1)["track_ids"] == [1, 2, 6]


def test_what_a_person_split_is_not_joined_by_way_of_others(editor: Editor, page: Page) -> None:
    editor.edit("split", track_ids=[3], frame_index=4)  # 3 and 6 now
    editor.edit("join", identity_ids=[3, 4])
    answer = editor.page.client.post(f"/api/merges/{page.merge(3, 4)['id']}/accept")
    assert answer.status_code == 200
    editor.edit("join", identity_ids=[5, 6])
    # 5 and 4 are in two cameras, but 6 is with 5, and 3 with 4
    lifted = editor.edit("join", identity_ids=[3, 5])
    assert lifted["identity_ids"] == [3]  # the last word of a person holds: all four are one


def test_objects_of_two_classes_of_persons_are_not_joined(editor: Editor, page: Page) -> None:
    editor.edit("class", identity_ids=[3], class_name="truck")
    editor.edit("class", identity_ids=[4], class_name="car")
    for answer in (
        editor.refused("join", identity_ids=[3, 4]),
        page.client.post(f"/api/merges/{page.merge(3, 4)['id']}/accept"),
    ):
        assert (answer.status_code, answer.json()["detail"]["code"]) == (409, "classes_differ")
        assert "object 3 is truck and object 4 is car" in answer.json()["detail"]["message"]


def test_swapped_identities_from_a_frame_on(editor: Editor, page: Page) -> None:
    # 1 (front 0-5, left 1-4) and 3 (left 2-5), from frame 4 on
    editor.edit("swap", identity_ids=[1, 3], frame_index=4)
    at = {key: label[3] for key, label in page.labels().items()}
    assert {frame: at[1, frame] for frame in (0, 3)} == {0: 1, 3: 1}
    assert at[2, 3] == 1
    assert at[3, 3] == 3
    later = {(seen["camera"], seen["box"][0]): seen["identity_id"] for seen in editor.frame(4)}
    # what stands at 10 in front and at 20 in left was 1; what stands at 40 in left was 3
    assert later == {("front", 10.0): 3, ("left", 20.0): 3, ("left", 40.0): 1}


def test_swapping_twice_is_as_if_nothing_was_swapped(editor: Editor, page: Page) -> None:
    def who() -> dict[tuple[str, float, int], Any]:
        return {(s["camera"], s["box"][0], f): s["identity_id"] for f in range(6) for s in editor.frame(f)}

    before = who()
    editor.edit("swap", identity_ids=[1, 3], frame_index=4)
    assert who() != before
    editor.edit("swap", identity_ids=[1, 3], frame_index=4)
    assert who() == before


def test_there_must_be_something_to_swap(editor: Editor) -> None:
    answer = editor.refused("swap", identity_ids=[4, 5], frame_index=5)
    assert "nothing to swap" in answer.json()["detail"]["message"]


@pytest.mark.parametrize(
    ("subjects", "gone"),
    [
        ({"identity_ids": [1]}, {1, 2}),
        ({"track_ids": [2, 5]}, {2, 5}),
        ({"observations": [{"track_id": 4, "frame_index": f} for f in (0, 1, 2)]}, {4}),
    ],
)
def test_what_is_deleted_is_gone(
    editor: Editor, page: Page, store: Store, subjects: dict[str, Any], gone: set[int]
) -> None:
    before = page.everything()
    editor.edit("delete", **subjects)
    assert {track for track, _ in page.labels()} == {1, 2, 3, 4, 5} - gone
    assert {track["id"] for track in page.get("tracks")} == {1, 2, 3, 4, 5} - gone
    assert not any({merge["track_a"], merge["track_b"]} & gone for merge in page.get("merges"))
    with store.read() as session:
        assert session.query(LabellingRow).one().observation_count == len(page.labels())
    editor.undo()
    assert page.everything() == before


def test_a_deleted_best_observation_labels_nothing(editor: Editor, page: Page) -> None:
    editor.edit("delete", observations=[{"track_id": 1, "frame_index": 2}])
    # the best left is .6: track 2 in frame 3 (truck) is earlier than track 1 in frame 4
    assert page.labels()[1, 0] == ("truck", 0.6, "propagated", 1)
    assert (1, 2) not in page.labels()


def test_a_drawn_box_replaces_that_of_the_machine(editor: Editor, page: Page) -> None:
    editor.edit("box", camera="front", frame_index=1, box=[12, 11, 30, 25], track_id=1)
    (seen,) = (one for one in editor.frame(1) if one["track_id"] == 1)
    assert (seen["box"], seen["score"], seen["filled"]) == ([12.0, 11.0, 30.0, 25.0], None, False)
    assert (seen["label"]["class_name"], seen["label"]["score"], seen["label"]["source"]) == ("car", 1.0, "human")
    assert seen["label"]["donor"] is None
    assert page.labels()[1, 0] == ("car", 0.9, "propagated", 1)
    editor.edit("box", camera="front", frame_index=1, box=[12, 11, 30, 26], track_id=1)
    assert next(one for one in editor.frame(1) if one["track_id"] == 1)["box"][3] == 26.0


def test_boxes_between_two_drawn_ones_lie_on_a_straight_way(editor: Editor) -> None:
    change = editor.edit("box", camera="right", frame_index=1, box=[10, 10, 20, 20], class_name="cone")
    (identity,) = change["identity_ids"]
    editor.edit("box", camera="right", frame_index=5, box=[50, 10, 60, 40], identity_id=identity)
    boxes = {f: one["box"] for f in range(6) for one in editor.frame(f) if one["identity_id"] == identity}
    assert boxes == {
        1: [10.0, 10.0, 20.0, 20.0],
        2: [20.0, 10.0, 30.0, 25.0],
        3: [30.0, 10.0, 40.0, 30.0],
        4: [40.0, 10.0, 50.0, 35.0],
        5: [50.0, 10.0, 60.0, 40.0],
    }
    editor.edit("box", camera="right", frame_index=3, box=[30, 0, 40, 20], identity_id=identity)
    assert [one["box"] for one in editor.frame(4) if one["identity_id"] == identity] == [[40.0, 5.0, 50.0, 30.0]]


def test_a_drawn_object_has_the_class_that_the_person_gave(editor: Editor, page: Page) -> None:
    change = editor.edit("box", camera="right", frame_index=5, box=[1, 1, 9, 9], class_name="cone")
    assert change["identity_ids"] == [6]
    identity = editor.identity(6)
    assert (identity["class_name"], identity["score"], identity["donor"]["score"]) == ("cone", 1.0, None)
    assert page.labels()[6, 5] == ("cone", 1.0, "human", 6)


def test_a_box_of_an_object_in_another_camera_joins_it(editor: Editor) -> None:
    change = editor.edit("box", camera="right", frame_index=5, box=[1, 1, 9, 9], identity_id=5)
    assert change["identity_ids"] == [5]
    assert editor.identity(5)["camera_names"] == ["front", "right"]
    assert editor.identity(5)["class_name"] == "cone"  # the machine's word, though its score is low


def test_interpolation_replaces_the_boxes_of_the_machine(editor: Editor) -> None:
    editor.edit("box", camera="front", frame_index=0, box=[0, 0, 10, 10], track_id=1, interpolate=False)
    editor.edit("box", camera="front", frame_index=4, box=[40, 0, 50, 10], track_id=1, interpolate=False)
    editor.edit("interpolate", track_id=1, first_frame=0, last_frame=4)
    boxes = [one["box"][0] for f in range(6) for one in editor.frame(f) if one["track_id"] == 1]
    assert boxes == [0.0, 10.0, 20.0, 30.0, 40.0, 10.0]


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"box": [5, 5, 5, 9]}, "invalid_request"),  # no width
        ({"box": [200, 5, 210, 9]}, "invalid_request"),  # outside of the image
        ({"frame_index": 6}, "invalid_request"),  # no such frame
        ({"camera": "rear"}, "not_found"),
        ({"track_id": 2}, "invalid_request"),  # in another camera
        ({"track_id": 99}, "not_found"),
        ({"track_id": None}, "invalid_request"),  # of what?
        ({"track_id": None, "class_name": "unicorn"}, "invalid_request"),
    ],
)
def test_boxes_that_are_refused(editor: Editor, change: dict[str, Any], code: str) -> None:
    asked = {"camera": "front", "frame_index": 1, "box": [5, 5, 9, 9], "track_id": 1} | change
    assert editor.refused("box", **asked).json()["detail"]["code"] == code


def test_marks_and_comments(editor: Editor) -> None:
    editor.edit("mark", identity_ids=[1, 3], mark="reviewed")
    editor.edit("comment", identity_ids=[3], text="hidden behind the bus")
    assert [editor.identity(n)["mark"] for n in (1, 3, 4)] == ["reviewed", "reviewed", None]
    assert editor.identity(3)["comment_count"] == 1
    (comment,) = editor.page.get("comments", identity_id=3)
    assert (comment["text"], comment["reviewer"], comment["identity_id"]) == ("hidden behind the bus", "local", 3)
    assert editor.page.get("comments", identity_id=1) == []
    editor.edit("mark", identity_ids=[3], mark="open")
    assert editor.identity(3)["mark"] is None
    assert editor.undo()["edit"]["mark"] == "open"
    assert editor.identity(3)["mark"] == "reviewed"


def test_one_edit_of_many_objects_is_one_step(editor: Editor, page: Page) -> None:
    before = page.everything()
    editor.edit("class", identity_ids=[1, 3, 4, 5], class_name="truck")
    assert {label[0] for label in page.labels().values()} == {"truck"}
    assert len(editor.log()["edits"]) == 1
    editor.undo()
    assert page.everything() == before


def test_undo_and_redo_go_through_all_decisions(editor: Editor, page: Page) -> None:
    states = [page.everything()]
    page.decide("accept", 3, 4)
    states.append(page.everything())
    editor.edit("class", identity_ids=[5], class_name="car")
    states.append(page.everything())
    page.decide("reject", 1, 2)
    states.append(page.everything())
    for state in reversed(states[:-1]):
        editor.undo()
        assert page.everything() == state
    assert editor.turned("undo").status_code == 409
    for state in states[1:]:
        editor.redo()
        assert page.everything() == state
    assert editor.turned("redo").status_code == 409


def test_a_new_decision_ends_redoing(editor: Editor) -> None:
    editor.edit("mark", identity_ids=[1], mark="reviewed")
    editor.undo()
    editor.edit("mark", identity_ids=[3], mark="reviewed")
    assert editor.turned("redo").status_code == 409
    assert editor.log()["redo"] is None


def test_the_log_says_who_did_what(editor: Editor) -> None:
    editor.edit("split", reviewer="Zoë", track_ids=[1], frame_index=3)
    editor.undo()
    log = editor.log()
    assert [(one["action"], one["reviewer"], one["undone"], one["target_id"]) for one in log["edits"]] == [
        ("undo_edit", "Zoë", False, 1),
        ("split", "Zoë", True, None),
    ]
    assert (log["edits"][1]["track_ids"], log["edits"][1]["frame_index"]) == ([1], 3)
    assert log["redo"]["id"] == 1
    assert editor.page.get("edits", limit=1)["next_before"] == 2
    assert [one["id"] for one in editor.page.get("edits", before=2)["edits"]] == [1]


def test_each_person_undoes_their_own(editor: Editor) -> None:
    editor.edit("mark", reviewer="Ada", identity_ids=[1], mark="reviewed")
    editor.edit("mark", reviewer="Bo", identity_ids=[3], mark="reviewed")
    assert editor.undo(reviewer="Ada")["edit"]["identity_ids"] == [1]
    assert editor.turned("undo", reviewer="Ada").status_code == 409
    assert editor.identity(3)["mark"] == "reviewed"


def test_an_edit_of_what_somebody_else_changed_is_refused(editor: Editor) -> None:
    seen = editor.revision()
    editor.edit("join", reviewer="Ada", identity_ids=[3, 4])
    answer = editor.refused("class", revision=seen, reviewer="Bo", identity_ids=[4], class_name="car")
    assert (answer.status_code, answer.json()["detail"]["code"]) == (409, "stale")
    assert "Ada changed object #3, #4 in the meantime (join" in answer.json()["detail"]["message"]
    # other objects are free
    editor.edit("class", revision=seen, reviewer="Bo", identity_ids=[5], class_name="car")


def test_undoing_what_later_decisions_need_is_refused(editor: Editor, page: Page) -> None:
    split = editor.edit("split", track_ids=[3], frame_index=4)  # 3 in frames 2-3, 6 in frames 4-5
    page.decide("reject", 1, 2)
    editor.edit("delete", observations=[{"track_id": 2, "frame_index": 4}])
    editor.edit("join", identity_ids=[2, 6])  # 2 in frames 1-3
    answer = editor.turned("undo", split["edit"]["id"])
    assert (answer.status_code, answer.json()["detail"]["code"]) == (409, "cannot_link")
    editor.undo()
    editor.undo(split["edit"]["id"])
    assert editor.identity(3)["last_frame"] == 5


def test_a_drawn_object_goes_only_with_what_was_said_of_it(editor: Editor) -> None:
    drawn = editor.edit("box", camera="right", frame_index=5, box=[1, 1, 9, 9], class_name="cone")
    said = editor.edit("mark", identity_ids=[6], mark="reviewed")
    answer = editor.turned("undo", drawn["edit"]["id"])
    assert f"number {said['edit']['id']} in the log" in answer.json()["detail"]["message"]
    editor.undo()
    editor.undo()
    assert [one["id"] for one in editor.page.get("identities")] == [1, 3, 4, 5]


def test_a_frame_that_was_emptied_can_be_drawn_in(editor: Editor) -> None:
    editor.edit("delete", track_ids=[4])
    editor.edit("box", camera="right", frame_index=1, box=[1, 1, 9, 9], class_name="car")
    editor.undo()
    editor.undo()
    assert editor.identity(4)["observation_count"] == 3
    editor.redo()
    assert [one["id"] for one in editor.page.get("identities")] == [1, 3, 5]


def test_there_is_nothing_to_correct_before_labelling(client: Any, drive_id: int) -> None:
    body = {"edit": {"kind": "mark", "identity_ids": [1], "mark": "reviewed"}}
    assert client.post(f"/api/drives/{drive_id}/edits", json=body).status_code == 409
    assert client.get(f"/api/drives/{drive_id}/edits").json()["edits"] == []
    assert client.get(f"/api/drives/{drive_id}/comments").json() == []


@pytest.mark.parametrize(
    "edit",
    [
        {"kind": "class", "identity_ids": [], "class_name": "car"},
        {"kind": "join", "identity_ids": [1]},
        {"kind": "delete"},
        {"kind": "comment", "identity_ids": [1], "text": ""},
        {"kind": "paint"},
    ],
)
def test_requests_that_are_not_valid(editor: Editor, edit: dict[str, Any]) -> None:
    answer = editor.page.client.post(f"/api/drives/{editor.page.drive_id}/edits", json={"edit": edit})
    assert answer.status_code == 422
