"""Edits after the drive was labelled again: they hold for the same objects under other numbers."""

from app.db.session import Store
from app.reviews.constraints import constraints_about
from app.tracks.importing import import_labelled_drive
from labeler.identity import Decisions
from tests.app.conftest import Page
from tests.app.edits.conftest import Editor
from tests.app.made_labels import TRACKS, make_labelled_drive
from tests.app.reviews.test_carrying import renumbered


def _label_again(store: Store, page: Page, *, without: int | None = None, key: str = "second") -> list[str]:
    tracks, merges = renumbered(without=without)
    import_labelled_drive(store, page.drive_id, make_labelled_drive(tracks, merges, key=key), model_name="made")
    warnings = page.client.get(f"/api/drives/{page.drive_id}").json()["warnings"]
    return [warning for warning in warnings if "decision" in warning]


def test_every_kind_of_edit_is_carried_over(editor: Editor, page: Page, store: Store) -> None:
    # 1, 2, 3, 4, 5 become 11, 8, 7, 15, 3
    editor.edit("split", track_ids=[1], frame_index=3)
    editor.edit("class", identity_ids=[3], class_name="truck")
    editor.edit("join", identity_ids=[4, 5])
    editor.edit("mark", identity_ids=[3], mark="ignored")
    editor.edit("comment", identity_ids=[3], text="seen")
    editor.edit("delete", observations=[{"track_id": 2, "frame_index": 4}])
    editor.edit("box", camera="right", frame_index=5, box=[1, 1, 9, 9], class_name="cone")
    editor.edit("mark", identity_ids=[7], mark="reviewed")
    assert _label_again(store, page) == []
    assert sorted(tuple(one["track_ids"]) for one in page.get("identities")) == [(3, 15), (7,), (8, 11), (16,), (17,)]
    third = editor.identity(7)
    assert (third["class_name"], third["mark"], third["comment_count"]) == ("truck", "ignored", 1)
    assert editor.identity(16)["first_frame"] == 3
    assert (8, 4) not in page.labels()
    drawn = editor.identity(17)
    assert (drawn["class_name"], drawn["mark"], drawn["camera_names"]) == ("cone", "reviewed", ["right"])


def test_an_edit_can_be_undone_and_made_again_after_labelling(editor: Editor, page: Page, store: Store) -> None:
    editor.edit("split", track_ids=[1], frame_index=3)
    _label_again(store, page)
    editor.undo()
    assert [one["id"] for one in editor.tracks_in("front")] == [3, 11]
    _label_again(store, page, key="third")
    editor.redo()
    assert [one["first_frame"] for one in editor.tracks_in("front")] == [0, 0, 3]


def test_an_edit_that_finds_no_track_waits_for_the_next_labelling(editor: Editor, page: Page, store: Store) -> None:
    editor.edit("class", identity_ids=[4], class_name="cone")
    (warning,) = _label_again(store, page, without=4)
    assert warning.startswith("1 earlier decision")
    import_labelled_drive(store, page.drive_id, make_labelled_drive(TRACKS, key="third"), model_name="made")
    assert editor.identity(4)["class_name"] == "cone"


def test_joins_are_constraints_on_the_next_run(editor: Editor, page: Page, store: Store) -> None:
    editor.edit("join", identity_ids=[4, 5])
    with store.read() as session:
        joined = constraints_about(session, page.drive_id)
    ((one, other),) = joined.same
    assert {one.camera, other.camera} == {"front", "right"}
    editor.undo()
    with store.read() as session:
        assert constraints_about(session, page.drive_id) == Decisions()
