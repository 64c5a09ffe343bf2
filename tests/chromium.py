"""The system's own Chromium, headless, for tests that need a real browser; Playwright's download is not used."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from playwright.sync_api import Browser, sync_playwright

PROGRAMS = ("chromium", "chromium-browser", "google-chrome")


def find_chromium() -> str:
    """Where Chromium lies. Where there is none the test is skipped, or fails with HINDSIGHT_REQUIRE_BROWSER=1."""
    for name in PROGRAMS:
        program = shutil.which(name)
        if program is not None:
            return program
    reason = f"needs Chromium ({', '.join(PROGRAMS)}), which is not on this machine; Debian: apt-get install chromium"
    if os.environ.get("HINDSIGHT_REQUIRE_BROWSER") == "1":
        pytest.fail(reason)
    pytest.skip(reason)


@contextmanager
def headless_chromium(*, webgl: bool = True) -> Iterator[Browser]:
    """A browser that draws WebGL in software, and the page itself by the same means, some five times slower than
    without ``webgl``. Only one at a time may run in a thread, so use it a module at most."""
    in_software = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]
    arguments = in_software if webgl else ["--disable-gpu"]
    if os.geteuid() == 0:
        arguments.append("--no-sandbox")  # Chromium refuses its sandbox to root
    program = find_chromium()
    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=program, args=arguments)
        yield running
        running.close()
