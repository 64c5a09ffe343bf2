"""Rejecting a donor: the identity is propagated anew without it."""

from typing import Any

import pytest

from app.db.session import Store
from app.tracks.importing import import_labelled_drive
from tests.app.conftest import Page
from tests.app.edits.conftest import Editor
from tests.app.made_labels import make_labelled_drive
from tests.app.reviews.test_carrying import renumbered


def _reject(editor: Editor, track_id: int, frame_index: int, **more: Any) -> Any:
    return editor.edit("donor", identity_id=1, track_id=track_id, frame_index=frame_index, **more)


def test_the_next_best_look_gives_the_label(editor: Editor, page: Page) -> None:
    before = page.everything()
    change = _reject(editor, 1, 2)  # the .9 of track 1
    # left are .6 of track 2 in frame 3 (a truck) and .6 of track 1 in frame 4 (a car): the earlier one
    assert (change["identity_ids"], change["edit"]["action"]) == ([1], "donor")
    assert (change["edit"]["camera"], change["edit"]["frame_index"]) == ("front", 2)
    identity = editor.identity(1)
    assert (identity["class_name"], identity["score"], identity["track_ids"]) == ("truck", 0.6, [1, 2])
    assert (identity["donor"]["track_id"], identity["donor"]["frame_index"]) == (2, 3)
    assert page.labels()[1, 2] == ("truck", 0.6, "propagated", 1)
    assert page.labels()[2, 3] == ("truck", 0.6, "auto", 1)
    editor.undo()
    assert page.everything() == before
    editor.redo()
    assert editor.identity(1)["donor"]["track_id"] == 2


def test_one_after_the_other(editor: Editor) -> None:
    _reject(editor, 1, 2)
    _reject(editor, 2, 3)
    identity = editor.identity(1)
    assert (identity["class_name"], identity["donor"]["track_id"], identity["donor"]["frame_index"]) == ("car", 1, 4)


def test_a_whole_track_is_no_donor(editor: Editor, page: Page) -> None:
    change = _reject(editor, 1, 2, whole_track=True)
    assert change["edit"]["frame_index"] is None
    assert {label for (track, _), label in page.labels().items() if track == 1} == {("truck", 0.6, "propagated", 1)}


@pytest.mark.parametrize("whole_track", [False, True])
def test_the_last_look_is_not_rejected(editor: Editor, whole_track: bool) -> None:
    _reject(editor, 1, 2, whole_track=True)
    for frame_index in (1, 2, 4):
        _reject(editor, 2, frame_index)
    answer = editor.refused("donor", identity_id=1, track_id=2, frame_index=3, whole_track=whole_track)
    assert (answer.status_code, answer.json()["detail"]["code"]) == (422, "invalid_request")
    assert "Give it a class instead" in answer.json()["detail"]["message"]


def test_a_class_of_a_person_has_no_donor(editor: Editor) -> None:
    editor.edit("class", identity_ids=[1], class_name="cone")
    answer = editor.refused("donor", identity_id=1, track_id=1, frame_index=2)
    assert "takes its label from no observation" in answer.json()["detail"]["message"]


def test_a_donor_of_another_object_is_refused(editor: Editor) -> None:
    answer = editor.refused("donor", identity_id=1, track_id=3, frame_index=4)
    assert "not of object 1" in answer.json()["detail"]["message"]


def test_it_is_refused_where_somebody_changed_the_object(editor: Editor) -> None:
    seen = editor.revision()
    editor.edit("mark", identity_ids=[1], mark="reviewed", reviewer="Zoë")
    answer = editor.refused("donor", identity_id=1, track_id=1, frame_index=2, revision=seen, reviewer="Ann")
    assert (answer.status_code, answer.json()["detail"]["code"]) == (409, "stale")
    assert "Zoë changed object #1" in answer.json()["detail"]["message"]


def test_it_holds_when_the_drive_is_labelled_again(editor: Editor, page: Page, store: Store) -> None:
    _reject(editor, 1, 2)
    tracks, merges = renumbered()  # 1 and 2 become 11 and 8
    import_labelled_drive(store, page.drive_id, make_labelled_drive(tracks, merges, key="second"), model_name="made")
    identity = editor.identity(8)
    assert (identity["track_ids"], identity["donor"]["track_id"], identity["class_name"]) == ([8, 11], 8, "truck")


def test_a_split_keeps_it_with_its_part(editor: Editor) -> None:
    _reject(editor, 1, 2)
    editor.edit("split", track_ids=[1], frame_index=4)
    # the first part of track 1 has .4 and .5 left, and is one with track 2
    assert editor.identity(1)["donor"]["track_id"] == 2
    assert (editor.identity(6)["score"], editor.identity(6)["donor"]["frame_index"]) == (0.6, 4)
