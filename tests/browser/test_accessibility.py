"""The pages in a real browser, checked by axe-core for faults that keep people from using them."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.browser.made_queue import store_queue

pytestmark = pytest.mark.browser

AXE = Path(__file__).resolve().parents[2] / "frontend/node_modules/axe-core/axe.min.js"
LABELLING_MS = 120_000
# What a page shows when it is whole, by its address.
PAGES = {
    "/": "Ready",
    "/drives/1?frame=4": "Is it the same object in both pictures?|Nothing left to decide",
    "/drives/1?frame=4&tab=identities": "#",
    "/drives/1?tab=export": "Write all labels",
    "/drives/1/evaluation": "How good the labels of|This drive has no truth",
}


def test_pages_have_no_serious_fault(page: Page, serve: Callable[..., str], made_drive: Path, made_model: Path) -> None:
    if not AXE.is_file():
        pytest.skip(f"axe-core is not at {AXE}: run `npm ci` in frontend")
    server = serve("--model", str(made_model)).rstrip("/")
    assert page.request.post(f"{server}/api/drives", data={"path": str(made_drive)}).ok
    assert page.request.post(f"{server}/api/drives/1/label", data={}).ok
    page.goto(server)
    expect(page.get_by_text("Ready", exact=True)).to_be_visible(timeout=LABELLING_MS)

    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme, reduced_motion="reduce")
        for path, words in PAGES.items():
            page.goto(server + path)
            shown = page.get_by_text(words.split("|")[0])
            for other in words.split("|")[1:]:
                shown = shown.or_(page.get_by_text(other))
            expect(shown.first).to_be_visible()
            assert _faults(page) == [], f"{path}, {scheme}"


def test_views_and_dialogs_have_no_serious_fault(page: Page, serve: Callable[..., str], tmp_path: Path) -> None:
    if not AXE.is_file():
        pytest.skip(f"axe-core is not at {AXE}: run `npm ci` in frontend")
    drive_id = store_queue(tmp_path / "workspace", tmp_path / "drive", merges=2)
    address = f"{serve().rstrip('/')}/drives/{drive_id}"
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme, reduced_motion="reduce")
        for name, show in VIEWS.items():
            show(page, address)
            assert _faults(page) == [], f"{name}, {scheme}"


def _show_queue(page: Page, address: str) -> None:
    page.goto(f"{address}?view=queue")
    expect(page.get_by_text("Are A and B the same object?")).to_be_visible()
    expect(page.get_by_role("region", name="Evidence")).to_be_visible()


def _show_summary(page: Page, address: str) -> None:
    page.goto(f"{address}/summary")
    expect(page.get_by_text("of 2 merges answered")).to_be_visible()


def _show_filter(page: Page, address: str) -> None:
    page.goto(f"{address}?tab=identities")
    page.get_by_role("button", name="Filter", exact=True).click()
    expect(page.get_by_role("textbox", name="Score, at least")).to_be_visible()


def _show_lineage(page: Page, address: str) -> None:
    page.goto(f"{address}?identity=3&tab=selected&frame=4")
    page.get_by_role("button", name="Reject", exact=True).click()
    expect(page.get_by_role("menuitem", name="This look is wrong")).to_be_visible()


def _show_keys(page: Page, address: str) -> None:
    page.goto(address)
    expect(page.get_by_text("Frame 1 of 6")).to_be_visible()
    page.keyboard.press("?")
    expect(page.get_by_role("dialog")).to_be_visible()


def _show_log(page: Page, address: str) -> None:
    page.goto(f"{address}?identity=3&tab=selected")
    expect(page.get_by_role("region", name="Corrections")).to_be_visible()
    page.keyboard.press("w")
    page.keyboard.press("h")
    expect(page.get_by_role("list", name="Log").get_by_text("#3 reviewed").first).to_be_visible()


VIEWS = {
    "queue": _show_queue,
    "summary": _show_summary,
    "filter": _show_filter,
    "lineage": _show_lineage,
    "keys": _show_keys,
    "log": _show_log,
}


def _faults(page: Page) -> list[str]:
    page.evaluate(AXE.read_text(encoding="utf-8"))
    # What viser shows in its frame is viser's own.
    found: dict[str, Any] = page.evaluate("axe.run(document, {iframes: false})")
    return [
        f"{fault['id']}: {fault['help']}: {node['html']}"
        for fault in found["violations"]
        if fault["impact"] in ("serious", "critical")
        for node in fault["nodes"]
    ]
