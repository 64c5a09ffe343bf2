"""The timeline of the review page, and its keys, used as a person does."""

import re

import pytest
from playwright.sync_api import Locator, Page, Position, expect

pytestmark = pytest.mark.browser

GUTTER_PX, GROUP_PX = 150, 22


def test_lanes_lead_to_frames_and_identities(page: Page, small_review: str) -> None:
    lanes = _open(page, small_review)
    expect(lanes).to_have_accessible_name("75 lanes, one for each identity")
    box = lanes.bounding_box()
    assert box is not None
    across = box["width"] - GUTTER_PX
    # The first lane below the head of the first group, in the middle of time.
    lanes.click(position={"x": GUTTER_PX + across * 0.505, "y": GROUP_PX + 8})
    expect(page.get_by_text("Frame 31 of 60")).to_be_visible()
    expect(page).to_have_url(re.compile(r"frame=30&identity=\d+"))
    address = page.url
    # Who opens that address sees the same.
    page.goto("about:blank")
    page.goto(address)
    expect(page.get_by_text("Frame 31 of 60")).to_be_visible()
    expect(page.get_by_text("Where the label comes from")).to_be_visible()


def test_groups_close_and_change(page: Page, small_review: str) -> None:
    lanes = _open(page, small_review)
    lanes.click(position={"x": 20, "y": GROUP_PX / 2})
    expect(lanes).not_to_have_accessible_name("75 lanes, one for each identity")
    lanes.click(position={"x": 20, "y": GROUP_PX / 2})
    expect(lanes).to_have_accessible_name("75 lanes, one for each identity")
    before = _canvas(lanes)
    page.get_by_text("Camera", exact=True).click()
    page.wait_for_function("([canvas, before]) => canvas.toDataURL() !== before", arg=[lanes.element_handle(), before])


def test_a_key_can_be_changed_and_conflicts_are_told(page: Page, small_review: str) -> None:
    _open(page, small_review)
    page.keyboard.press("?")
    dialog = page.get_by_role("dialog")
    dialog.get_by_role("button", name="Change the key of: Next frame").click()
    page.keyboard.press("z")
    expect(dialog.get_by_role("button", name="Change the key of: Next frame")).to_have_text("Z")
    dialog.get_by_role("button", name="Change the key of: Previous frame").click()
    page.keyboard.press("z")
    expect(dialog.get_by_role("alert")).to_contain_text("Z is already “Next frame”.")
    dialog.get_by_role("button", name="Cancel").click()
    page.keyboard.press("Escape")
    expect(dialog).to_be_hidden()
    page.keyboard.press("z")
    expect(page.get_by_text("Frame 2 of 60")).to_be_visible()

    expect(page).to_have_url(re.compile("frame=1$"))  # the address follows a moment later
    page.reload()
    expect(page.get_by_text("Frame 2 of 60")).to_be_visible()
    page.keyboard.press("Home")
    expect(page.get_by_text("Frame 1 of 60")).to_be_visible()
    page.keyboard.press("z")
    expect(page.get_by_text("Frame 2 of 60")).to_be_visible()


def _open(page: Page, address: str) -> Locator:
    page.goto(address)
    lanes = page.get_by_role("img", name=re.compile("lanes, one for each identity"))
    expect(lanes).to_be_visible()
    expect(page.get_by_role("figure", name=re.compile("^rear, "))).to_be_visible()
    return lanes


def _canvas(canvas: Locator) -> str:
    return canvas.evaluate("(canvas) => canvas.toDataURL()")


def test_the_wheel_zooms_time_about_the_pointer(page: Page, small_review: str) -> None:
    lanes = _open(page, small_review)
    box = lanes.bounding_box()
    assert box is not None
    middle: Position = {"x": GUTTER_PX + (box["width"] - GUTTER_PX) * 0.505, "y": GROUP_PX + 8}
    whole = page.get_by_role("button", name="Whole drive")
    before = _canvas(lanes)
    lanes.hover(position=middle)
    page.keyboard.down("Control")
    page.mouse.wheel(0, -400)
    page.keyboard.up("Control")
    page.wait_for_function("([canvas, before]) => canvas.toDataURL() !== before", arg=[lanes.element_handle(), before])
    lanes.click(position=middle)  # what was under the pointer is there still
    expect(page.get_by_text("Frame 31 of 60")).to_be_visible()
    whole.click()
    lanes.click(position={"x": GUTTER_PX + 3, "y": GROUP_PX + 8})
    expect(page.get_by_text("Frame 1 of 60")).to_be_visible()
