"""Finding identities, trying a threshold, and the summary, in a real browser."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.browser.made_queue import store_queue

pytestmark = pytest.mark.browser


@pytest.fixture
def address(serve: Callable[..., str], tmp_path: Path) -> str:
    """The address of a drive with 5 identities: 2 proposed pairs, and one that the machine merged."""
    drive_id = store_queue(tmp_path / "workspace", tmp_path / "drive", merges=2)
    return f"{serve().rstrip('/')}/drives/{drive_id}"


def test_identities_are_found_by_text_and_filter_which_live_in_the_address(page: Page, address: str) -> None:
    page.goto(f"{address}?tab=identities")
    expect(page.get_by_text("5 identities", exact=True)).to_be_visible()
    page.get_by_role("textbox", name="Find identities").fill("left")
    expect(page.get_by_text("3 identities", exact=True)).to_be_visible()  # 101, 102, and 3 with its track in left
    expect(page).to_have_url(re.compile("find=text:left"))

    page.get_by_role("button", name="Filter", exact=True).click()
    page.get_by_role("textbox", name="Score, at least").fill("0.5")
    expect(page.get_by_text("1 identity", exact=True)).to_be_visible()
    page.get_by_role("textbox", name="Name for this filter").fill("sure ones in left")
    page.get_by_role("button", name="Keep").click()
    page.keyboard.press("Escape")

    page.reload()
    expect(page.get_by_text("1 identity", exact=True)).to_be_visible()
    page.get_by_role("button", name="Clear the filter").click()
    expect(page.get_by_text("5 identities", exact=True)).to_be_visible()
    page.get_by_role("button", name="Filter", exact=True).click()
    page.get_by_role("button", name="sure ones in left", exact=True).click()
    expect(page.get_by_text("1 identity", exact=True)).to_be_visible()


def test_a_threshold_is_tried_without_asking_the_server(page: Page, address: str) -> None:
    page.goto(f"{address}?tab=export")
    exported = page.locator("div", has=page.get_by_text("labels exported", exact=True)).last
    # pair n of 1, 2 and 3 has 6 - n boxes on each side: 10, 8 and 6
    expect(exported).to_contain_text("24")
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.get_by_role("textbox", name="Lowest score").fill("0.5")
    # the 3 boxes of 103 took the .9 of track 3; those of 101 and 102 still have their .4
    expect(exported).to_contain_text("15")
    assert [url for url in asked if "histogram" in url] == []


def test_the_summary_counts_labels_and_leads_to_the_queue(page: Page, address: str) -> None:
    page.goto(f"{address}/summary")
    expect(page.get_by_text("24 labels of 5 identities in 3 cameras.")).to_be_visible()
    expect(page.get_by_text("0 of 2 merges answered")).to_be_visible()
    expect(page.get_by_role("row", name=re.compile("^car 24$"))).to_be_visible()
    page.get_by_role("link", name="Merge queue").click()
    expect(page.get_by_text("Are A and B the same object?")).to_be_visible()
