"""The cameras of the review page, used as a person does: scrub, zoom, colour, adjust, select."""

import re
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.big_drive.pictures import BITS, SQUARE_PX
from tests.big_drive.traffic import CAMERAS, HEIGHT_PX, WIDTH_PX

pytestmark = pytest.mark.browser

PLAYED_MS = 120_000

# On each animation frame, for as long as it is asked to: the frame that each camera says it shows, and the number that
# its picture carries in black and white squares. Reading a picture back is slow, so it is read when what is said
# changes, and now and then in between.
WATCH = """({bits, square, width, height}) => {
  window.seen = [];
  let last = "", since = 0;
  const numberOf = (canvas) => {
    const scale = canvas.width / width;
    const y = Math.round((height - square / 2) * scale);
    const row = canvas.getContext("2d").getImageData(0, y, Math.ceil(bits * square * scale), 1).data;
    let number = 0;
    for (let bit = 0; bit < bits; bit += 1) {
      number = number * 2 + (row[4 * Math.round((bit + 0.5) * square * scale)] > 127 ? 1 : 0);
    }
    return number;
  };
  const look = () => {
    const figures = [...document.querySelectorAll("figure[data-frame]")];
    const said = figures.map((figure) => figure.dataset.frame).join();
    since += 1;
    if (said !== last || since > 20) {
      last = said;
      since = 0;
      window.seen.push(figures.map((one) => [Number(one.dataset.frame), numberOf(one.querySelector("canvas"))]));
    }
    window.watching = requestAnimationFrame(look);
  };
  look();
}"""


def test_scrubbing_never_shows_boxes_of_another_frame(page: Page, small_review: str) -> None:
    _open(page, small_review)
    page.evaluate(WATCH, {"bits": BITS, "square": SQUARE_PX, "width": WIDTH_PX, "height": HEIGHT_PX})
    ruler = page.get_by_role("slider", name="Frame")
    box = ruler.bounding_box()
    assert box is not None
    middle = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + 2, middle)
    page.mouse.down()
    for part in (0.9, 0.1, 0.6, 0.95, 0.3, 0.75):
        page.mouse.move(box["x"] + box["width"] * part, middle, steps=8)
    page.mouse.up()
    expect(page.get_by_text("Frame 46 of 60")).to_be_visible()
    expect(_view(page, "front")).to_have_attribute("data-frame", "45")
    seen: list[list[tuple[int, int]]] = page.evaluate("() => { cancelAnimationFrame(window.watching); return seen; }")
    frames_shown = {said for views in seen for said, _ in views}
    assert len(frames_shown) > 3, "the pictures did not follow the hand"
    for views in seen:
        assert len({said for said, _ in views}) <= 1, "two cameras showed two frames at once"
        assert [said for said, _ in views] == [number for _, number in views], "boxes stood on another frame's picture"


def test_what_is_shown_first_is_asked_for_once(page: Page, small_review: str) -> None:
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    _open(page, f"{small_review}?frame=45")
    first = ["", "/observations?start=45&stop=46", *(f"/frames/45/images/{camera}" for camera in CAMERAS)]
    api = small_review.replace("/drives/", "/api/drives/")
    assert {one: asked.count(api + one) for one in first} == dict.fromkeys(first, 1)


def test_playing_shows_every_frame(page: Page, small_review: str) -> None:
    _open(page, f"{small_review}?frame=45")
    page.evaluate(WATCH, {"bits": BITS, "square": SQUARE_PX, "width": WIDTH_PX, "height": HEIGHT_PX})
    page.keyboard.press("Space")
    # Playback waits for what is not here yet, and a busy machine takes its time to read the pictures back.
    expect(_view(page, "front")).to_have_attribute("data-frame", "59", timeout=PLAYED_MS)
    page.wait_for_function("() => seen.at(-1).every(([, number]) => number === 59)")
    seen: list[list[tuple[int, int]]] = page.evaluate("() => { cancelAnimationFrame(window.watching); return seen; }")
    shown = list(dict.fromkeys(number for views in seen for _, number in views))
    assert shown == list(range(45, 60))


def test_zoom_and_pan(page: Page, small_review: str) -> None:
    _open(page, small_review)
    view = _view(page, "left")
    expect(view).to_have_attribute("data-zoom", "1")
    view.hover()
    page.mouse.wheel(0, -600)
    expect(view).not_to_have_attribute("data-zoom", "1")
    expect(_view(page, "front")).to_have_attribute("data-zoom", "1")
    before = _pixels(view)
    box = view.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] / 2 + 60, box["y"] + box["height"] / 2 + 30, steps=4)
    page.mouse.up()
    assert _pixels(view) != before, "dragging did not move the picture"
    assert "identity=" not in page.url, "dragging selected something"

    page.keyboard.press("0")
    expect(view).to_have_attribute("data-zoom", "1")
    page.keyboard.press("+")
    expect(view).to_have_attribute("data-zoom", "1.4")
    view.get_by_role("button", name="Show the whole picture").click()
    expect(view).to_have_attribute("data-zoom", "1")
    view.dblclick(position={"x": 30, "y": 20})
    expect(view).to_have_attribute("data-zoom", "3")


def test_colours_and_adjustments_are_kept(page: Page, small_review: str) -> None:
    _open(page, small_review)
    boxes = _view(page, "front").locator("canvas").nth(1)
    by_identity = _canvas(boxes)
    page.get_by_text("Class", exact=True).first.click()
    legend = page.get_by_role("list", name="How boxes are drawn")
    expect(legend.get_by_text("car", exact=True).last).to_be_visible()
    assert _canvas(boxes) != by_identity
    for name, words in (("Score", "0.85"), ("Origin", "another camera")):
        page.get_by_text(name, exact=True).first.click()
        expect(legend.get_by_text(words)).to_be_visible()

    page.get_by_role("button", name="Brightness, contrast, gamma").click()
    page.get_by_role("slider", name="Brightness").focus()
    page.keyboard.press("ArrowRight")
    page.get_by_role("slider", name="Gamma").focus()
    page.keyboard.press("ArrowRight")
    picture = _view(page, "front").locator("canvas").first
    expect(picture).to_have_css("filter", re.compile(r'url\("#picture-gamma"\) brightness\(1\.05\)'))
    page.reload()
    expect(picture).to_have_css("filter", re.compile("brightness"))
    expect(legend.get_by_text("another camera")).to_be_visible()
    page.get_by_role("button", name="Brightness, contrast, gamma").click()
    page.get_by_role("button", name="As recorded").click()
    expect(picture).to_have_css("filter", "none")


def test_pointing_and_clicking_select_in_all_cameras(page: Page, small_review: str) -> None:
    _open(page, f"{small_review}?frame=30")
    observations = page.request.get(f"{small_review.replace('/drives', '/api/drives')}/observations?start=30&stop=31")
    found: list[dict[str, Any]] = observations.json()["frames"][0]["observations"]
    # The largest box of the front camera has a corner that no smaller box covers.
    target = max((one for one in found if one["camera"] == "front"), key=lambda one: _area(one["box"]))
    view = _view(page, "front")
    box = view.bounding_box()
    assert box is not None
    x = (target["box"][0] + 1) / WIDTH_PX * box["width"]
    y = (target["box"][1] + 1) / HEIGHT_PX * box["height"]
    before = {camera: _canvas(_view(page, camera).locator("canvas").nth(1)) for camera in CAMERAS}
    view.click(position={"x": max(1, x), "y": max(1, y)})
    expect(page).to_have_url(re.compile(r"identity=\d+"))
    # What is not selected steps back, in every camera.
    for camera in CAMERAS:
        assert _canvas(_view(page, camera).locator("canvas").nth(1)) != before[camera], camera
    page.keyboard.press("Escape")
    expect(page).not_to_have_url(re.compile("identity="))


def _open(page: Page, address: str) -> None:
    page.goto(address)
    expect(_view(page, "rear")).to_be_visible()


def _view(page: Page, camera: str) -> Locator:
    return page.get_by_role("figure", name=re.compile(f"^{camera}, "))


def _area(box: list[float]) -> float:
    return (box[2] - box[0]) * (box[3] - box[1])


def _pixels(view: Locator) -> str:
    return _canvas(view.locator("canvas").first)


def _canvas(canvas: Locator) -> str:
    return canvas.evaluate("(canvas) => canvas.toDataURL()")
