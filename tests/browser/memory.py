"""What the review page takes of memory while it plays, in a Chromium that nothing else watches.

Playwright has DevTools record the network's traffic, and that keeps up to 100 MB of answers in the process of the page:
it would be measured with it. So this talks to Chromium itself, and asks for nothing but what it needs.
"""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
import time
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from websockets.sync.client import connect

from tests.chromium import find_chromium

BEGIN_SECONDS = 60.0
SAMPLE_SECONDS = 30.0
LOOK_SECONDS = 2.0

SHOWN = 'document.querySelectorAll("figure[data-frame]").length >= 4'
# At the end of the drive playback stops: it is begun again, from the start.
PLAY = """[...document.querySelectorAll("button")].find((one) => one.ariaLabel === "Play")?.click()"""
FRAME = 'Number(document.querySelector("figure[data-frame]").dataset.frame)'

Report = Callable[[str, str], None]


def watch_memory(address: str, *, minutes: float, size: tuple[int, int], report: Report) -> dict[str, list[float]]:
    """MB of the page's heap after collection, and of its whole process, each half minute of playback."""
    found: dict[str, list[float]] = {"heap_mb": [], "renderer_mb": []}
    with _chromium(size) as devtools:
        devtools.send("HeapProfiler.enable")
        devtools.send("Page.navigate", url=address)
        devtools.wait(SHOWN)
        for sample in range(round(minutes * 60 / SAMPLE_SECONDS) + 1):
            until = time.monotonic() + (SAMPLE_SECONDS if sample else 0)
            while time.monotonic() < until:
                devtools.evaluate(PLAY)
                time.sleep(LOOK_SECONDS)
            devtools.send("HeapProfiler.collectGarbage")
            found["heap_mb"].append(round(devtools.send("Runtime.getHeapUsage")["usedSize"] / 1e6, 1))
            found["renderer_mb"].append(round(_renderers_mb(), 1))
            report(
                f"memory after {sample * SAMPLE_SECONDS / 60:.1f} min",
                f"heap {found['heap_mb'][-1]} MB, renderer {found['renderer_mb'][-1]} MB, "
                f"at frame {devtools.evaluate(FRAME)}",
            )
    return found


class _DevTools:
    """One page's DevTools."""

    def __init__(self, address: str) -> None:
        self._socket = connect(address, max_size=None)
        self._asked = 0

    def send(self, method: str, **params: Any) -> dict[str, Any]:
        self._asked += 1
        self._socket.send(json.dumps({"id": self._asked, "method": method, "params": params}))
        while True:
            answer = json.loads(self._socket.recv())
            if answer.get("id") == self._asked:  # events are passed over
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]

    def evaluate(self, expression: str) -> Any:
        return self.send("Runtime.evaluate", expression=expression, returnByValue=True)["result"].get("value")

    def wait(self, expression: str) -> None:
        until = time.monotonic() + BEGIN_SECONDS
        while not self.evaluate(expression):
            if time.monotonic() > until:
                raise TimeoutError(f"not within {BEGIN_SECONDS:.0f} s: {expression}")
            time.sleep(0.1)


@contextmanager
def _chromium(size: tuple[int, int]) -> Iterator[_DevTools]:
    with tempfile.TemporaryDirectory(prefix="hindsight-chromium-") as profile:
        arguments = ["--headless=new", "--disable-gpu", "--disable-3d-apis", "--no-first-run"]
        arguments += ["--remote-debugging-port=0", f"--user-data-dir={profile}", f"--window-size={size[0]},{size[1]}"]
        if os.geteuid() == 0:
            arguments.append("--no-sandbox")  # Chromium refuses its sandbox to root
        process = subprocess.Popen([find_chromium(), *arguments, "about:blank"], stderr=subprocess.DEVNULL)
        try:
            yield _DevTools(_page_address(Path(profile) / "DevToolsActivePort"))
        finally:
            process.terminate()
            process.wait()


def _page_address(port_file: Path) -> str:
    """Where the DevTools of the first page listen: Chromium writes its port into the file."""
    until = time.monotonic() + BEGIN_SECONDS
    while time.monotonic() < until:
        if port_file.exists() and (port := port_file.read_text().split("\n")[0]):
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/json") as answer:
                pages = [one for one in json.load(answer) if one["type"] == "page"]
            if pages:
                return pages[0]["webSocketDebuggerUrl"]
        time.sleep(0.1)
    raise TimeoutError(f"Chromium did not start within {BEGIN_SECONDS:.0f} s.")


def _renderers_mb() -> float:
    """Resident memory of the largest renderer below this process, from /proc."""
    parents: dict[int, int] = {}
    sizes: dict[int, float] = {}
    for folder in Path("/proc").iterdir():
        if not folder.name.isdigit():
            continue
        try:
            status = dict(line.split(":", 1) for line in (folder / "status").read_text().splitlines() if ":" in line)
            parents[int(folder.name)] = int(status["PPid"])
            if b"--type=renderer" in (folder / "cmdline").read_bytes():
                sizes[int(folder.name)] = int(status["VmRSS"].split()[0]) / 1000
        except (OSError, KeyError):
            continue  # it has ended meanwhile

    def is_ours(process: int) -> bool:
        while process in parents and process != os.getpid():
            process = parents[process]
        return process == os.getpid()

    return max((size for process, size in sizes.items() if is_ours(process)), default=0.0)
