"""The built page in a real browser: it comes up, and talks to nobody but its own server."""

from collections.abc import Callable

import pytest
from playwright.sync_api import Page, expect

pytestmark = pytest.mark.browser


def test_page_comes_up_and_asks_no_other_host(page: Page, serve: Callable[..., str]) -> None:
    address = serve()
    asked: list[str] = []
    page.context.on("request", lambda request: asked.append(request.url))
    page.goto(address)
    expect(page.get_by_role("heading").first).to_be_visible()
    page.wait_for_load_state("networkidle")
    assert any(url.endswith(".js") for url in asked), "the page is not built; run `make frontend`"
    assert [url for url in asked if not url.startswith((f"{address}/", "data:", "blob:"))] == []
