"""A real server for a browser to open."""

import os
import queue
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

ANSWER_SECONDS = 60.0
REPOSITORY = Path(__file__).resolve().parents[2]


def models_of(workspace: Path) -> Path:
    """The folder of models that a server on this workspace uses."""
    return workspace / "models"


@contextmanager
def serving(workspace: Path, *arguments: str) -> Iterator[str]:
    """``hindsight serve`` on a free port while the block runs; gives its address."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("HINDSIGHT_")}
    process = subprocess.Popen(
        [sys.executable, "-m", "app", "serve", "--port", "0", "--workspace", str(workspace), *arguments],
        cwd=REPOSITORY,
        env=environment | {"PYTHONUNBUFFERED": "1", "HINDSIGHT_MODELS": str(models_of(workspace))},
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


def _read_lines(stream: IO[str], lines: queue.Queue[str | None]) -> None:
    for line in stream:
        lines.put(line)
    lines.put(None)


def _address(lines: queue.Queue[str | None]) -> str:
    said: list[str] = []
    while True:
        line = lines.get(timeout=ANSWER_SECONDS)
        if line is None:
            raise RuntimeError(f"hindsight serve ended at once: {''.join(said)}")
        said.append(line)
        address = re.search(r"http://[^\s/]+", line)
        if address is not None:
            return address[0]
