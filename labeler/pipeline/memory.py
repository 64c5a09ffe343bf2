"""How much memory a run takes at its peak."""

from __future__ import annotations

import threading
from types import TracebackType

import psutil

_BYTES_PER_MB = 1e6


class PeakMemory:
    """Watches the resident memory of this process and its workers while it is entered.

    It looks every ``interval_s`` seconds and adds up the processes, so pages that workers share count more than once.
    """

    def __init__(self, *, interval_s: float = 0.05) -> None:
        self._interval_s = interval_s
        self._stop = threading.Event()
        self._peak_bytes = 0
        self._thread = threading.Thread(target=self._watch, name="peak-memory", daemon=True)

    @property
    def peak_mb(self) -> float:
        """The largest sum so far, in megabytes."""
        return self._peak_bytes / _BYTES_PER_MB

    def _watch(self) -> None:
        process = psutil.Process()
        while True:
            self._peak_bytes = max(self._peak_bytes, _resident_bytes(process))
            if self._stop.wait(self._interval_s):
                return

    def __enter__(self) -> PeakMemory:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stop.set()
        self._thread.join()


def _resident_bytes(process: psutil.Process) -> int:
    total = process.memory_info().rss
    for child in process.children(recursive=True):
        try:
            total += child.memory_info().rss
        except psutil.NoSuchProcess:
            continue
    return total
