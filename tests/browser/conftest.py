"""A real headless Chromium, and a real server for it to open."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.big_drive.making import SMALL, make_workspace
from tests.browser.serving import serving
from tests.chromium import headless_chromium

SHOWN_MS = 60_000


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Headless Chromium; see :mod:`tests.chromium` for what happens where there is none."""
    expect.set_options(timeout=SHOWN_MS)  # a machine that is busy with other tests shows things late
    with headless_chromium() as running:
        yield running


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """An empty tab in a profile of its own. The test fails when the page throws an error that nobody catches."""
    context = browser.new_context(viewport={"width": 1600, "height": 1000}, color_scheme="light")
    context.set_default_timeout(SHOWN_MS)
    tab = context.new_page()
    errors: list[str] = []
    tab.on("pageerror", lambda error: errors.append(str(error)))
    yield tab
    context.close()
    assert errors == []


@pytest.fixture
def serve(tmp_path: Path) -> Iterator[Callable[..., str]]:
    """Starts ``hindsight serve`` with more arguments on an empty workspace, until the test ends; gives its address."""
    with ExitStack() as running:
        yield lambda *arguments: running.enter_context(serving(tmp_path / "workspace", *arguments))


@pytest.fixture(scope="session")
def small_review(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a review page of a drive made by code: 60 frames x 4 cameras, 75 identities. Tests only look."""
    workspace = tmp_path_factory.mktemp("small") / "workspace"
    make_workspace(workspace, SMALL)
    with serving(workspace) as address:
        yield f"{address.rstrip('/')}/drives/1"
