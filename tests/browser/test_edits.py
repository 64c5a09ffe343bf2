"""Corrections in a real browser, as a user makes them: by key, by dragging, with somebody else on the same drive."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

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


def test_swapping_by_key(page: Page, review: str) -> None:
    _open(page, review, "3,4")
    page.keyboard.press("Alt+s")
    _said(page, "#3, #4 swapped from frame 4 on")
    # 4 was seen until frame 3 only, so 3 ends there and what was 3 is 4 from here on: in another camera
    expect(page.get_by_role("region", name="#4 car").get_by_text("left", exact=True).first).to_be_visible()
    page.keyboard.press("Control+z")
    _said(page, "Undone: #3, #4 swapped from frame 4 on")


def test_deleting_a_box_and_an_object(page: Page, review: str) -> None:
    _open(page, review, "3")
    left = page.get_by_role("figure", name=re.compile("^left"))
    expect(left).to_have_accessible_name("left, 2 boxes")
    page.keyboard.press("Delete")
    _said(page, "Box of #3 deleted in frame 4")
    expect(left).to_have_accessible_name("left, 1 box")
    page.get_by_role("button", name="Delete").click()
    page.get_by_role("menuitem", name="Object").click()
    _said(page, "#3 deleted")
    page.get_by_role("tab", name=re.compile("^Identities")).click()
    expect(page.get_by_text("3 identities", exact=True)).to_be_visible()
    page.keyboard.press("Control+z")
    expect(page.get_by_text("4 identities", exact=True)).to_be_visible()


def test_drawing_a_new_object_and_filling_between_keyframes(page: Page, review: str) -> None:
    page.goto(f"{review}?frame=0")
    right = page.get_by_role("figure", name=re.compile("^right"))
    expect(right).to_have_accessible_name("right, 1 box")
    page.keyboard.press("b")
    expect(page.get_by_role("region", name="Drawing")).to_contain_text("Drawing a new object")
    _drag(page, right, (5, 40), (25, 55))
    _said(page, "Box of a new object drawn in right, frame 1")
    expect(right).to_have_accessible_name("right, 2 boxes")
    page.keyboard.press("End")
    expect(right).to_have_accessible_name("right, 0 boxes")
    _drag(page, right, (35, 40), (55, 55))
    _said(page, "Box of #6 drawn in right, frame 6")
    page.keyboard.press("Escape")
    # the frames between two boxes that a person drew are filled on the straight way
    for key in ("d", "d", "d"):
        page.keyboard.press(key)
    expect(page.get_by_text("Frame 3 of 6")).to_be_visible()
    expect(right).to_have_accessible_name("right, 2 boxes")
    page.keyboard.press("Delete")
    _said(page, "Box of #6 deleted in frame 3")
    page.keyboard.press("End")
    expect(page.get_by_text("Frame 6 of 6")).to_be_visible()
    expect(right).to_have_accessible_name("right, 1 box")
    page.keyboard.press("i")
    _said(page, "Boxes of #6 filled between frames 1 and 6")
    page.keyboard.press("Home")
    for key in ("f", "f"):
        page.keyboard.press(key)
    expect(page.get_by_text("Frame 3 of 6")).to_be_visible()
    expect(right).to_have_accessible_name("right, 2 boxes")


def test_several_objects_are_marked_at_once(page: Page, review: str) -> None:
    page.goto(f"{review}?frame=3&tab=identities")
    page.get_by_role("button", name=re.compile("^#3 car")).click()
    page.get_by_role("button", name=re.compile("^#4 truck")).click(modifiers=["Control"])
    page.get_by_role("button", name=re.compile("^#5 cone")).click(modifiers=["Control"])
    page.get_by_role("tab", name=re.compile("^Selected")).click()
    expect(page.get_by_text("3 objects selected")).to_be_visible()
    page.keyboard.press("w")
    _said(page, "#3, #4, #5 reviewed")
    page.keyboard.press("x")
    _said(page, "#3, #4, #5 ignored")
    page.get_by_role("tab", name=re.compile("^Identities")).click()
    expect(page.get_by_role("img", name="ignored, not exported")).to_have_count(3)
    page.keyboard.press("o")
    expect(page.get_by_role("img", name="ignored, not exported")).to_have_count(0)


def test_a_donor_is_rejected_and_the_next_best_look_takes_its_place(page: Page, review: str) -> None:
    _open(page, review, "1")
    lineage = page.get_by_role("region", name="#1 car")
    # the best look has a 3D box 12 m ahead and half a metre to the left
    expect(lineage.get_by_text("then: score 0.90, 12 m")).to_be_visible()
    page.keyboard.press("Alt+g")
    _said(page, "Donor of #1 rejected: front, frame 3")
    now = page.get_by_role("region", name="#1 truck")
    expect(now.get_by_text("then: score 0.60, distance not measured")).to_be_visible()
    page.get_by_role("button", name="Reject", exact=True).click()
    page.get_by_role("menuitem", name="All of this track is wrong").click()
    _said(page, "Donor of #1 rejected: all of its track in left")
    expect(page.get_by_role("region", name="#1 car").get_by_text("then: score 0.60, 12 m")).to_be_visible()
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    expect(lineage.get_by_text("then: score 0.90, 12 m")).to_be_visible()


def _drag(page: Page, view: Locator, start: tuple[float, float], end: tuple[float, float]) -> None:
    """From one place to another, in pixels of the recorded picture."""
    picture = view.bounding_box()
    assert picture is not None
    px = picture["width"] / WIDTH_PX
    page.mouse.move(picture["x"] + start[0] * px, picture["y"] + start[1] * px)
    page.mouse.down()
    page.mouse.move(picture["x"] + end[0] * px, picture["y"] + end[1] * px, steps=4)
    page.mouse.up()
