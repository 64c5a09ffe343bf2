"""The merge queue in a real browser: a person who has only the keyboard answers twenty merges."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.made_queue import store_queue

pytestmark = pytest.mark.browser

MERGES = 20
MOST_KEYS = 25
COUNT_KEYS = "window.keysPressed = 0; window.addEventListener('keydown', () => { window.keysPressed += 1; }, true)"


@pytest.fixture
def queue_of_20(serve: Callable[..., str], tmp_path: Path) -> str:
    """The address of a drive with 20 proposed merges and one that the machine made."""
    drive_id = store_queue(tmp_path / "workspace", tmp_path / "drive", merges=MERGES)
    return f"{serve().rstrip('/')}/drives/{drive_id}"


def test_twenty_merges_are_answered_by_keyboard_alone(page: Page, queue_of_20: str) -> None:
    page.goto(queue_of_20)
    expect(page.get_by_role("button", name="Merge queue")).to_be_visible()
    page.evaluate(COUNT_KEYS)
    page.keyboard.press("q")
    expect(page.get_by_text("0 of 20 answered")).to_be_visible()
    expect(page.get_by_text("Are A and B the same object?")).to_be_visible()

    # The keys stand on the buttons: accept, reject and unsure, each also with Ctrl where the issue asks for it.
    for number in range(MERGES):
        shown = page.get_by_role("article", name=re.compile("^Merge of tracks"))
        expect(shown.get_by_role("img", name=re.compile("^A: front")).first).to_be_visible()
        page.keyboard.press(("a", "Control+Enter", "r", "s", "Control+ ")[number % 5])
        expect(page.get_by_text(f"{number + 1} of 20 answered")).to_be_visible()
    expect(page.get_by_text("every proposed merge is answered")).to_be_visible()

    # Ctrl is a key of its own: 8 of the 20 answers take two, and the first opens the queue.
    assert page.evaluate("window.keysPressed") == 1 + MERGES + 8
    _wait_until_saved(page)
    merges = _merges(page, queue_of_20)
    assert [merge["state"] for merge in merges if merge["decided_by"] == "machine"] == ["accepted"]
    states = [merge["state"] for merge in merges if merge["decided_by"] == "person"]
    assert (states.count("accepted"), states.count("rejected"), states.count("unsure")) == (8, 4, 8)


def test_a_queue_takes_one_key_a_merge(page: Page, queue_of_20: str) -> None:
    page.goto(queue_of_20)
    expect(page.get_by_role("button", name="Merge queue")).to_be_visible()
    page.evaluate(COUNT_KEYS)
    page.keyboard.press("q")
    expect(page.get_by_text("0 of 20 answered")).to_be_visible()
    for _ in range(MERGES):
        page.keyboard.press("a")  # as fast as the keyboard goes: decisions are saved behind it
    expect(page.get_by_text("20 of 20 answered")).to_be_visible()
    assert page.evaluate("window.keysPressed") <= MOST_KEYS
    expect(page.get_by_text("every proposed merge is answered")).to_be_visible()
    _wait_until_saved(page)
    assert {merge["state"] for merge in _merges(page, queue_of_20)} == {"accepted"}


def test_a_card_shows_what_helps_to_answer_and_the_next_is_already_there(page: Page, queue_of_20: str) -> None:
    page.goto(f"{queue_of_20}?view=queue")
    card = page.get_by_role("article", name=re.compile("^Merge of tracks"))
    for words in ("At the same moment", "Each at its best", "From camera to camera over time", "changes 6 labels"):
        expect(card.get_by_text(words).first).to_be_visible()
    # the most labels at the greatest uncertainty first: 6 labels at .48, at .52 (as uncertain, but younger), at .44
    rows = page.get_by_role("navigation", name="Merges in the queue").get_by_role("button").all()
    assert [re.findall(r"\d+%", row.inner_text()) for row in rows[:3]] == [["48%"], ["52%"], ["44%"]]
    expect(card).to_have_accessible_name("Merge of tracks 8 and 108")
    expect(card.get_by_role("img", name="A: front, frame 3").first).to_have_js_property("complete", True)
    expect(card.get_by_role("button", name="left, frame 6")).to_be_visible()
    # Three are fetched ahead: looks, and four pictures of which at least three differ.
    fetched = "part => performance.getEntriesByType('resource').filter(one => one.name.includes(part)).length"
    page.wait_for_function(f"() => ({fetched})('/looks') >= 4 && ({fetched})('max_width=720') >= 12")

    page.keyboard.press("a")
    expect(card).to_have_accessible_name("Merge of tracks 12 and 112")
    # at once: nothing is waited for here
    here = "images => images.map(image => image.complete && image.naturalWidth > 0)"
    assert card.locator("img[alt^='A: '], img[alt^='B: ']").evaluate_all(here) == [True] * 4


def test_automatic_merges_are_reviewed_and_undone_in_the_same_place(page: Page, queue_of_20: str) -> None:
    page.goto(f"{queue_of_20}?view=queue")
    page.get_by_text("Made by the machine 1").click()
    card = page.get_by_role("article", name="Merge of tracks 21 and 121")
    expect(card).to_be_visible()
    page.keyboard.press("r")
    expect(page.get_by_text("Decided 1")).to_be_visible()
    expect(card.get_by_text("A person says: these are two objects.")).to_be_visible()
    page.keyboard.press("u")
    expect(page.get_by_text("Made by the machine 1")).to_be_visible()
    expect(card.get_by_text("The machine says: it is the same object.")).to_be_visible()


def test_from_the_queue_to_the_cameras_and_back(page: Page, queue_of_20: str) -> None:
    page.goto(f"{queue_of_20}?view=queue")
    card = page.get_by_role("article", name="Merge of tracks 8 and 108")
    card.get_by_role("button", name="left, frame 6").click()
    expect(page.get_by_text("Frame 6 of 6")).to_be_visible()
    expect(page).to_have_url(re.compile("merge="))
    page.keyboard.press("q")
    expect(card).to_be_visible()
    expect(page).to_have_url(re.compile("view=queue"))


def _wait_until_saved(page: Page) -> None:
    """Answers are shown at once and saved behind that; the header counts what is saved."""
    expect(page.get_by_text("No proposals left")).to_be_visible()


def _merges(page: Page, address: str) -> list[dict[str, Any]]:
    server, drive_id = address.split("/drives/")
    return page.request.get(f"{server}/api/drives/{drive_id}/merges").json()
