"""Work on images in threads of this process.

Decoding (OpenCV) and inference (onnxruntime) let other Python threads run, so each thread takes whole images through
both. With one intra-op thread a session, that keeps all cores busy where splitting a small network's operators over
them would not. Only a few images are in memory at a time.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import islice
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


def in_threads(
    work: Callable[[Item], Result], items: Iterator[Item], *, threads: int, name: str
) -> Iterator[tuple[Item, Result]]:
    """The items with what ``work`` makes of them, in order; at most two per thread are under way."""
    running: deque[tuple[Item, Future[Result]]] = deque()
    with ThreadPoolExecutor(threads, thread_name_prefix=name) as pool:
        try:
            for item in islice(items, 2 * threads):
                running.append((item, pool.submit(work, item)))
            while running:
                item, result = running.popleft()
                yield item, result.result()
                for following in islice(items, 1):
                    running.append((following, pool.submit(work, following)))
        finally:
            pool.shutdown(wait=True, cancel_futures=True)
