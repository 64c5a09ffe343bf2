"""A user's whole path in a real browser: upload a drive, wait for its labels, review it, export a dataset."""

import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

pytestmark = pytest.mark.browser

LABELLING_MS = 120_000


def test_from_upload_to_export_on_the_made_drive(
    page: Page, serve: Callable[..., str], made_drive: Path, made_model: Path, tmp_path: Path
) -> None:
    _upload_and_open(page, serve("--model", str(made_model)), made_drive, tmp_path)

    for camera in ("front", "left"):
        expect(_view(page, camera)).to_be_visible()
    expect(_view(page, "front")).to_have_accessible_name("front, 2 boxes")

    # The machine has merged the car that crosses; a person takes that back and makes it again.
    page.get_by_text("Accepted 1").click()
    _merge_card(page).click()
    page.keyboard.press("r")
    expect(page.get_by_text("Rejected 1")).to_be_visible()
    expect(page.get_by_role("tab", name=re.compile(r"^Identities\s*3"))).to_be_visible()
    page.keyboard.press("u")
    expect(page.get_by_text("Accepted 1")).to_be_visible()
    expect(page.get_by_role("tab", name=re.compile(r"^Identities\s*2"))).to_be_visible()

    _step_through_frames(page, frames=12)
    _select_identity_in_a_picture(page)
    expect(page.frame_locator("iframe").locator("canvas").first).to_be_visible()

    dataset = _export(page, tmp_path)
    assert {image["camera"] for image in dataset["images"]} == {"front", "left"}
    assert len(dataset["images"]) == 24
    assert {category["name"] for category in dataset["categories"]} >= {"car"}
    assert len({annotation["identity_id"] for annotation in dataset["annotations"]}) == 2


@pytest.mark.real_drive
def test_from_upload_to_export_on_a_recorded_drive(
    page: Page, serve: Callable[..., str], tri_scene_01: Path, yolox_nano_dynamic: Path, tmp_path: Path
) -> None:
    _upload_and_open(page, serve("--model", str(yolox_nano_dynamic)), tri_scene_01, tmp_path)
    for camera in ("ring_front_center", "ring_front_left", "ring_front_right"):
        expect(_view(page, camera)).to_have_accessible_name(re.compile(f"{camera}, [1-9][0-9]* box"))

    accepted = page.get_by_text(re.compile(r"^Accepted \d+$"))
    count = int(accepted.inner_text().split()[1])
    assert count >= 1
    accepted.click()
    _merge_card(page).click()
    page.keyboard.press("r")
    expect(page.get_by_text(f"Accepted {count - 1}")).to_be_visible()
    page.keyboard.press("u")
    expect(page.get_by_text(f"Accepted {count}")).to_be_visible()

    _step_through_frames(page, frames=3)
    expect(page.frame_locator("iframe").locator("canvas").first).to_be_visible()
    dataset = _export(page, tmp_path)
    assert len(dataset["images"]) == 9
    assert any(annotation["attributes"]["source"] == "propagated" for annotation in dataset["annotations"])


def _upload_and_open(page: Page, address: str, drive: Path, folder: Path) -> None:
    archive = shutil.make_archive(str(folder / "a drive"), "zip", root_dir=drive)
    page.goto(address)
    expect(page.get_by_text("Start with a recorded drive")).to_be_visible()
    page.locator("input[type=file]").set_input_files(archive)
    expect(page.get_by_text("Ready", exact=True)).to_be_visible(timeout=LABELLING_MS)
    page.get_by_role("link", name=re.compile("^Review")).click()
    expect(page.get_by_text(re.compile(r"^Frame 1 of \d+$"))).to_be_visible()


def _view(page: Page, camera: str) -> Locator:
    return page.get_by_role("figure", name=re.compile(f"^{camera}, "))


def _merge_card(page: Page) -> Locator:
    return page.get_by_text(re.compile(r" · \d+ labels?$")).first


def _step_through_frames(page: Page, *, frames: int) -> None:
    page.keyboard.press("End")
    expect(page.get_by_text(f"Frame {frames} of {frames}")).to_be_visible()
    expect(page).to_have_url(re.compile(f"frame={frames - 1}"))
    page.keyboard.press("d")
    page.keyboard.press("Home")
    page.keyboard.press("f")
    expect(page.get_by_text(f"Frame 2 of {frames}")).to_be_visible()
    page.keyboard.press("Home")
    page.keyboard.press("Space")
    expect(page.get_by_text(f"Frame {frames} of {frames}")).to_be_visible()


def _select_identity_in_a_picture(page: Page) -> None:
    """The parked car stands at the same place in every frame: 188..252 x 96..120 of 320 x 192 pixels."""
    page.keyboard.press("Escape")
    view = _view(page, "front")
    box = view.bounding_box()
    assert box is not None
    view.click(position={"x": box["width"] * 220 / 320, "y": box["height"] * 98 / 192})
    expect(page).to_have_url(re.compile("identity=100000"))
    expect(page.get_by_text("Where the label comes from")).to_be_visible()


def _export(page: Page, folder: Path) -> dict[str, Any]:
    page.get_by_role("tab", name="Export").click()
    page.get_by_role("button", name="Export").click()
    link = page.get_by_role("link", name="Download")
    expect(link).to_be_visible()
    with page.expect_download() as download:
        link.click()
    path = folder / "dataset.json"
    download.value.save_as(path)
    return json.loads(path.read_text())
