"""A person says that two tracks are two objects, though other merges tie them."""

import pytest

from app.db.session import Store
from app.tracks.importing import import_labelled_drive
from labeler.identity.types import MergeState
from tests.app.browser import Browser
from tests.app.conftest import Page
from tests.app.edits.conftest import Editor
from tests.app.made_labels import make_labelled_drive

TRIANGLE = (
    (1, 2, 0.8, MergeState.ACCEPTED),
    (1, 4, 0.7, MergeState.ACCEPTED),
    (2, 4, 0.6, MergeState.ACCEPTED),
)


@pytest.fixture
def page(client: Browser, store: Store, drive_id: int) -> Page:
    """Tracks 1, 2 and 4 are one object by three merges."""
    assert import_labelled_drive(store, drive_id, make_labelled_drive(merges=TRIANGLE), model_name="made")
    return Page(client, drive_id)


def _refusal(page: Page, verb: str, track_a: int, track_b: int) -> str:
    """Why a decision is refused; nothing may have changed by it."""
    before = page.everything()
    answer = page.client.post(f"/api/merges/{page.merge(track_a, track_b)['id']}/{verb}")
    assert (answer.status_code, answer.json()["detail"]["code"]) == (409, "cannot_link")
    assert page.everything() == before
    return answer.json()["detail"]["message"]


def _tracks_of_identities(page: Page) -> list[list[int]]:
    return [identity["track_ids"] for identity in page.get("identities")]


def test_the_weakest_merge_that_ties_them_gives_way(page: Page) -> None:
    before = page.everything()
    assert page.merge(1, 2)["label_count"] == 4  # the labels of 2, which goes
    rejected = page.decide("reject", 1, 2)
    assert (rejected["changed_label_count"], rejected["identity_ids"]) == (4, [1, 2])
    assert _tracks_of_identities(page) == [[1, 4], [2], [3], [5]]
    weakest = page.merge(2, 4)
    assert (weakest["state"], weakest["decided_by"]) == ("proposed", "machine")
    page.decide("undo", 1, 2)
    assert page.everything() == before


def test_changing_ones_mind(page: Page) -> None:
    before = page.everything()
    page.decide("reject", 1, 2)
    assert page.decide("accept", 1, 2)["changed_label_count"] == 4
    assert page.everything() == before


def test_what_would_tie_them_again_is_refused(page: Page, editor: Editor) -> None:
    page.decide("reject", 1, 2)
    number = editor.log()["edits"][0]["id"]
    assert _refusal(page, "accept", 2, 4) == (
        "Tracks 2 and 4 can't be one object: a person said that tracks 2 and 1 are two objects. Undo that decision "
        f"first: it is number {number} in the log."
    )
    page.decide("undo", 1, 2)
    page.decide("accept", 2, 4)
    assert _tracks_of_identities(page) == [[1, 2, 4], [3], [5]]


def test_what_people_tied_does_not_give_way(page: Page) -> None:
    page.decide("accept", 1, 4)
    page.decide("accept", 2, 4)
    message = _refusal(page, "reject", 1, 2)
    assert message == (
        "Tracks 1 and 2 are one object by what people decided: tracks 2 and 4 are one. Undo that decision first."
    )


def test_joining_takes_back_that_they_are_two_until_it_is_undone(page: Page, editor: Editor) -> None:
    page.decide("reject", 1, 2)
    editor.edit("join", identity_ids=[1, 2])
    assert _tracks_of_identities(page) == [[1, 2, 4], [3], [5]]
    editor.undo()
    assert _tracks_of_identities(page) == [[1, 4], [2], [3], [5]]
