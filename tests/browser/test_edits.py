"""Corrections in a real browser, as a user makes them: by key, by dragging, with somebody else on the same drive."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from app.db.engine import migrate, open_engine
from app.db.session import Store
from app.drives.schemas import DriveRegistration
from app.drives.service import add_local_drive
from app.settings import Settings
from app.tracks.importing import import_labelled_drive
from tests.app.made_labels import WIDTH_PX, make_labelled_drive, write_three_camera_drive
from tests.browser.conftest import serving

pytestmark = pytest.mark.browser


@pytest.fixture
def review(tmp_path: Path) -> Iterator[str]:
    """The address of the review page of a drive with the labels of tests/app/made_labels.py."""
    settings = Settings(workspace=tmp_path / "workspace", min_free_bytes=0)
    engine = open_engine(settings.store_url)
    migrate(engine)
    store = Store(engine)
    drive = write_three_camera_drive(tmp_path / "drive")
    drive_id = add_local_drive(store, DriveRegistration(path=str(drive))).id
    import_labelled_drive(store, drive_id, make_labelled_drive(), model_name="made")
    engine.dispose()
    with serving(settings.workspace) as address:
        yield f"{address}/drives/{drive_id}"


def _open(page: Page, review: str, identities: str) -> None:
    page.goto(f"{review}?identity={identities}&tab=selected&frame=3")
    expect(page.get_by_role("region", name="Corrections")).to_be_visible()
    expect(page.get_by_role("figure", name=re.compile("^left"))).to_be_visible()


def _said(page: Page, words: str) -> None:
    expect(page.get_by_text(words, exact=True).first).to_be_visible()


def test_correcting_by_keys_with_undo_redo_and_the_log(page: Page, review: str) -> None:
    _open(page, review, "1")
    page.keyboard.press("2")
    _said(page, "#1 is truck")
    expect(page.get_by_role("heading", name="#1 truck")).to_be_visible()
    page.keyboard.press("Alt+m")
    _said(page, "Track 1, 2 split at frame 4")
    page.keyboard.press("Control+z")
    _said(page, "Undone: Track 1, 2 split at frame 4")
    page.keyboard.press("Control+z")
    expect(page.get_by_role("heading", name="#1 car")).to_be_visible()
    page.keyboard.press("Control+Shift+Z")
    expect(page.get_by_role("heading", name="#1 truck")).to_be_visible()
    page.keyboard.press("n")
    page.keyboard.type("behind the bus")
    page.keyboard.press("Control+Enter")
    _said(page, "#1: “behind the bus”")
    expect(page.get_by_placeholder("What should others know?")).to_have_count(0)
    page.keyboard.press("h")
    log = page.get_by_role("list", name="Log")
    expect(log.get_by_role("listitem")).to_have_count(6)
    log.get_by_role("button", name="Undo number 1").click()
    expect(log.get_by_role("button", name="Make number 1 again")).to_be_visible()


def test_joining_and_drawing(page: Page, review: str) -> None:
    _open(page, review, "3,4")
    expect(page.get_by_text("2 objects selected")).to_be_visible()
    page.keyboard.press("m")
    _said(page, "#3, #4 joined")
    page.keyboard.press("b")
    expect(page.get_by_role("region", name="Drawing")).to_be_visible()
    picture = page.get_by_role("figure", name=re.compile("^left")).bounding_box()
    assert picture is not None
    px = picture["width"] / WIDTH_PX
    # the lower right corner of the box of #3, to another place
    page.mouse.move(picture["x"] + 48 * px, picture["y"] + 20 * px)
    page.mouse.down()
    page.mouse.move(picture["x"] + 60 * px, picture["y"] + 35 * px, steps=4)
    page.mouse.up()
    _said(page, "Box of #3 drawn in left, frame 4")
    page.keyboard.press("Escape")
    expect(page.get_by_role("region", name="Drawing")).to_have_count(0)
    expect(page.get_by_role("heading", name="#3 car")).to_be_visible()


def test_two_people_at_once(page: Page, browser: Browser, review: str) -> None:
    _open(page, review, "4")
    other = browser.new_context().new_page()
    _open(other, review, "3,4")
    other.keyboard.press("h")
    other.get_by_label("Your name").fill("Zoë")
    other.keyboard.press("Escape")
    other.keyboard.press("m")
    _said(other, "#3, #4 joined")
    _said(page, "Zoë: #3, #4 joined")
    expect(page.get_by_text("This identity is no more", exact=False)).to_be_visible()
    other.context.close()
