"""A real headless Chromium, and a real server for it to open."""

import os
import queue
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import IO

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.big_drive.making import SMALL, make_workspace
from tests.chromium import headless_chromium

ANSWER_SECONDS = 60.0
SHOWN_MS = 30_000
REPOSITORY = Path(__file__).resolve().parents[2]


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
    tab = context.new_page()
    errors: list[str] = []
    tab.on("pageerror", lambda error: errors.append(str(error)))
    yield tab
    context.close()
    assert errors == []


@contextmanager
def serving(workspace: Path, *arguments: str) -> Iterator[str]:
    """``hindsight serve`` on a free port while the block runs; gives its address."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("HINDSIGHT_")}
    process = subprocess.Popen(
        [sys.executable, "-m", "app", "serve", "--port", "0", "--workspace", str(workspace), *arguments],
        cwd=REPOSITORY,
        env=environment | {"PYTHONUNBUFFERED": "1"},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert process.stdout is not None
    lines: queue.Queue[str | None] = queue.Queue()
    reader = threading.Thread(target=_read_lines, args=(process.stdout, lines))
    reader.start()
    try:
        yield _address(lines)
    finally:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(30)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        reader.join()
        process.stdout.close()


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


def _read_lines(stream: IO[str], lines: queue.Queue[str | None]) -> None:
    for line in stream:
        lines.put(line)
    lines.put(None)


def _address(lines: queue.Queue[str | None]) -> str:
    said: list[str] = []
    while True:
        line = lines.get(timeout=ANSWER_SECONDS)
        if line is None:
            pytest.fail(f"hindsight serve ended at once: {''.join(said)}")
        said.append(line)
        address = re.search(r"http://[^\s/]+", line)
        if address is not None:
            return address[0]
