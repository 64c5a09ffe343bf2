"""The viewer's page in a real browser: it draws, and it talks to this server alone."""

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import cv2
import httpx
import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from app.scene.palette import identity_color, scene_palette
from app.scene.types import SceneBox, SceneSource, Theme
from labeler.drive import open_drive
from labeler.drive.types import Camera, Drive, Sweep, TruthBoxes3D
from tests.chromium import headless_chromium

WIDTH, HEIGHT = 480, 300  # small: without a graphics card, each pixel costs time
DEADLINE_S = 60.0
TOLERANCE = 45  # lines are smoothed, and the brightest colours come out a little darker


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with headless_chromium() as running:
        yield running


class TruthSource:
    """A recorded drive with its true boxes; identities count up in the order in which objects appear."""

    def __init__(self, drive: Drive) -> None:
        truth = drive.read_truth(drive.frames)
        assert truth is not None
        assert truth.boxes_3d is not None
        self._drive, self._truth = drive, truth.boxes_3d
        self._numbers = {uuid: number for number, uuid in enumerate(dict.fromkeys(self._truth.track_uuid))}
        self.cameras: tuple[Camera, ...] = drive.cameras
        self.frame_count = len(drive.frames)

    def sweep(self, frame_index: int) -> Sweep | None:
        file = self._drive.frames[frame_index].sweep
        return None if file is None else self._drive.read_sweep(file)

    def boxes(self, frame_index: int) -> list[SceneBox]:
        truth: TruthBoxes3D = self._truth
        return [
            SceneBox(
                center_m=tuple(truth.center_m[row].tolist()),
                size_m=tuple(truth.size_m[row].tolist()),
                yaw_rad=float(truth.yaw_rad[row]),
                identity_id=self._numbers[truth.track_uuid[row]],
                class_name=truth.category[row].lower(),
                score=None,
            )
            for row in np.flatnonzero(truth.frame_index == frame_index)
        ]


def open_page(browser: Browser, server: Any, drive_id: int, **start: object) -> tuple[Page, str, list[str]]:
    """The viewer's page, the scene's id, and every address that the page asks for, as it asks."""
    answer = httpx.post(f"{server.origin}/api/drives/{drive_id}/scenes", json=start)
    assert answer.status_code == 201
    page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("websocket", lambda websocket: asked.append(websocket.url))
    page.goto(f"{server.origin}{answer.json()['url']}?fixedDpr=1")  # else viser blurs the picture where it is slow
    return page, answer.json()["scene_id"], asked


def picture(page: Page) -> np.ndarray:
    """(HEIGHT, WIDTH, 3) RGB int."""
    encoded = np.frombuffer(page.screenshot(), np.uint8)
    bgr = cv2.imdecode(encoded, cv2.IMREAD_COLOR)
    assert bgr is not None
    return bgr[:, :, ::-1].astype(int)


def count_of(image: np.ndarray, color: tuple[int, int, int], tolerance: int) -> int:
    return int((np.abs(image - np.array(color)).max(axis=2) <= tolerance).sum())


def wait_for_color(page: Page, color: tuple[int, int, int], at_least: int) -> np.ndarray:
    """The first picture with this much of a colour."""
    deadline = time.monotonic() + DEADLINE_S
    while count_of(image := picture(page), color, TOLERANCE) < at_least:
        assert time.monotonic() < deadline, (
            f"{count_of(image, color, TOLERANCE)} pixels of {color} after {DEADLINE_S:.0f} s"
        )
    return image


@pytest.mark.browser
def test_the_selected_object_is_drawn_in_its_color(browser: Browser, server: Any) -> None:
    page, scene_id, asked = open_page(browser, server, 1)
    thin = count_of(wait_for_color(page, identity_color(3), at_least=10), identity_color(3), TOLERANCE)
    update = {"frame_index": 0, "identity_id": 3}
    assert httpx.put(f"{server.origin}/api/scenes/{scene_id}/view", json=update).status_code == 204
    wait_for_color(page, identity_color(3), at_least=round(1.5 * thin))  # thick lines now
    assert {urlsplit(url).netloc for url in asked if not url.startswith(("data:", "blob:"))} == {server.host}
    page.close()


@pytest.mark.browser
def test_the_policy_stops_requests_to_others(browser: Browser, server: Any) -> None:
    page, _, _ = open_page(browser, server, 1)
    blocked = page.evaluate(
        """() => new Promise(resolve => {
            document.addEventListener("securitypolicyviolation", event => resolve(event.effectiveDirective));
            fetch("http://127.0.0.1:9/").catch(() => undefined);
        })"""
    )
    assert blocked == "connect-src"
    page.close()


@pytest.mark.browser
@pytest.mark.real_drive
@pytest.mark.parametrize("theme", list(Theme))
def test_a_recorded_drive_fills_the_view(
    browser: Browser,
    server: Any,
    sources: dict[int, SceneSource],
    tri_scene_01: Path,
    theme: Theme,
) -> None:
    sources[2] = TruthSource(open_drive(tri_scene_01))
    nearest_ahead = min(
        sources[2].boxes(0), key=lambda box: abs(box.center_m[0] - 12) + abs(box.center_m[1] - 9)
    ).identity_id
    assert nearest_ahead is not None
    page, _, asked = open_page(browser, server, 2, theme=theme, identity_id=nearest_ahead)
    image = wait_for_color(page, identity_color(nearest_ahead, theme), at_least=40)
    empty = count_of(image, scene_palette(theme).background, tolerance=4) / (WIDTH * HEIGHT)
    assert 0.3 < empty < 0.95  # neither blank nor covered
    assert {urlsplit(url).netloc for url in asked if not url.startswith(("data:", "blob:"))} == {server.host}
    page.close()
