"""Take the pictures of the review page: dark and light, of the drive that ships with Hindsight.

    hindsight demo --no-serve --workspace FOLDER
    hindsight serve --workspace FOLDER --port 8000 --no-open &
    python docs/images/take_pictures.py http://127.0.0.1:8000

Needs the extra `dev`, and Chromium.
"""

import json
import re
import sys
import urllib.request
from pathlib import Path

from playwright.sync_api import Page, expect

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from tests.chromium import headless_chromium

SIZE = {"width": 1600, "height": 1000}
TIMEOUT_MS = 120_000


def main(address: str) -> None:
    """Write review-dark.png and review-light.png beside this file."""
    with urllib.request.urlopen(f"{address}/api/drives") as answer:
        drive = json.load(answer)[0]
    with headless_chromium() as browser:
        for scheme in ("dark", "light"):
            page = browser.new_page(viewport=SIZE, color_scheme=scheme)
            page.set_default_timeout(TIMEOUT_MS)
            page.goto(f"{address}/drives/{drive['id']}")
            show_a_merge(page)
            page.screenshot(path=Path(__file__).with_name(f"review-{scheme}.png"))
            page.close()


def show_a_merge(page: Page) -> None:
    """Open a proposed merge of the front and the left camera, and wait until pictures and the 3D view are there."""
    page.get_by_role("button", name="Got it").click()
    page.get_by_role("button", name=re.compile("^front, .* left, ")).last.click()
    expect(page.get_by_role("button", name="Accept").first).to_be_visible(timeout=TIMEOUT_MS)
    expect(page.frame_locator("iframe").locator("canvas").first).to_be_visible(timeout=TIMEOUT_MS)
    page.wait_for_timeout(12_000)  # neither pictures nor the 3D view say when they are drawn


if __name__ == "__main__":
    main(sys.argv[1])
