"""The answer to a decision: who patches it into what was read before knows all that is to be known.

The labels are those of tests/app/made_labels.py.
"""

from collections.abc import Callable, Mapping
from typing import Any

import pytest
from pydantic import TypeAdapter

from app.changes import service
from app.changes.schemas import EditChange, MergeChange
from app.db.session import Store
from tests.app.conftest import Page
from tests.app.edits.conftest import Editor

Step = Callable[[Page, Editor], Any]


def decided(verb: str, track_a: int, track_b: int) -> Step:
    return lambda page, _: page.decide(verb, track_a, track_b)


def edited(kind: str, **content: Any) -> Step:
    return lambda _, editor: editor.edit(kind, **content)


def undone(_: Page, editor: Editor) -> Any:
    return editor.undo()


def redone(_: Page, editor: Editor) -> Any:
    return editor.redo()


STEPS: dict[str, list[Step]] = {
    # two objects become one, are parted, and are one again; a merge that people's words forbid follows
    "merges": [decided("accept", 3, 4), decided("reject", 1, 2), decided("undo", 1, 2), decided("accept", 3, 4)],
    "a merge that stays open": [decided("unsure", 3, 4), undone, redone],
    "a class": [edited("class", identity_ids=[1, 3], class_name="cone"), undone, redone],
    # tracks appear and vanish; the merge about 1 and 2 goes with one of the parts
    "a split": [edited("split", track_ids=[1], frame_index=2), undone, redone, edited("join", identity_ids=[1, 2])],
    "a join": [edited("join", identity_ids=[3, 4]), undone],
    "a swap": [edited("swap", identity_ids=[1, 3], frame_index=4), undone],
    # an object with its merges; then the donor of an object, so that its label comes from elsewhere
    "an object deleted": [edited("delete", identity_ids=[3]), undone, redone],
    "a track deleted": [edited("delete", track_ids=[2]), undone],
    "a box deleted": [edited("delete", observations=[{"track_id": 1, "frame_index": 2}]), undone],
    "a new object": [
        edited("box", camera="right", frame_index=4, box=[1, 2, 30, 40], class_name="cone"),
        edited("box", camera="right", frame_index=5, box=[2, 2, 31, 40], class_name="car"),
        undone,
        redone,
    ],
    "boxes between drawn ones": [
        edited("box", camera="left", frame_index=0, box=[1, 2, 30, 40], track_id=2),
        edited("box", camera="left", frame_index=5, box=[9, 2, 38, 40], track_id=2),
        undone,
    ],
    "a donor": [edited("donor", identity_id=1, track_id=1, frame_index=2), undone],
    "words": [
        edited("mark", identity_ids=[1, 4], mark="reviewed"),
        edited("comment", identity_ids=[4], text="a trailer"),
        undone,
    ],
}


@pytest.fixture
def editor(page: Page, store: Store) -> Editor:
    return Editor(page, store)


@pytest.mark.parametrize("steps", STEPS.values(), ids=list(STEPS))
def test_who_patches_knows_what_who_asks_again_knows(steps: list[Step], page: Page, editor: Editor) -> None:
    known = Known(page)
    for step in steps:
        known.patch(step(page, editor))
        again = Known(page)
        assert known.merges == again.merges
        assert known.identities == again.identities
        assert known.tracks == again.tracks
        assert known.observations == again.observations


def test_the_answers_are_of_the_form_that_the_api_promises(page: Page, editor: Editor) -> None:
    of_merge, of_edit = page.decide("accept", 3, 4), editor.edit("split", track_ids=[1], frame_index=2)
    for form, change in ((MergeChange, of_merge), (EditChange, of_edit)):
        assert TypeAdapter(form).validate_python(change).model_dump(mode="json") == change


def test_more_labels_than_are_quick_to_tell_are_not_told(editor: Editor, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(service, "MOST_OBSERVATIONS", 9)  # object 1 has ten labels
    change = editor.edit("class", identity_ids=[1], class_name="truck")
    assert change["observations"] is None
    assert change["changed_track_ids"] == [1, 2]
    assert editor.undo()["observations"] is None
    monkeypatch.setattr(service, "MOST_OBSERVATIONS", 10)
    change = editor.edit("class", identity_ids=[1], class_name="truck")
    assert sum(len(frame["observations"]) for frame in change["observations"]) == 10


class Known:
    """What a page has read of a drive: it patches as the page does."""

    def __init__(self, page: Page) -> None:
        self.identities = _by_id(page.get("identities"))
        self.tracks = _by_id(page.get("tracks"))
        self.merges = _by_id(page.get("merges"))
        frames = page.get("observations", start=0, stop=6)["frames"]
        self.observations = {frame["frame_index"]: _by_id(frame["observations"]) for frame in frames}

    def patch(self, change: Mapping[str, Any]) -> None:
        self.identities = _without(self.identities, "id", change["gone_identity_ids"]) | _by_id(change["identities"])
        changed = change["changed_track_ids"]
        self.tracks = _without(self.tracks, "id", changed) | _by_id(change["tracks"])
        reached = {*changed, *(track["id"] for track in change["tracks"])}
        for side in ("track_a", "track_b"):
            self.merges = _without(self.merges, side, reached)
        self.merges |= _by_id(change["merges"])
        for frame, seen in self.observations.items():
            self.observations[frame] = _without(seen, "track_id", changed)
        for frame in change["observations"]:
            self.observations[frame["frame_index"]] |= _by_id(frame["observations"])


def _by_id(rows: list[Any]) -> dict[int, Any]:
    return {row["id"]: row for row in rows}


def _without(rows: dict[int, Any], name: str, values: Any) -> dict[int, Any]:
    return {key: row for key, row in rows.items() if row[name] not in values}
