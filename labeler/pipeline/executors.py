"""Who does the units of work of a stage.

An executor gives the results in the order of the units, and holds only a few of them at a time. ``serial`` does one
after the other in this process. ``processes`` hands them to worker processes. Stages whose work happens in native code
that lets other Python threads run (detection) use ``workers`` threads in this process instead of worker processes.
"""

from __future__ import annotations

import os
import signal
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from importlib import import_module
from types import TracebackType
from typing import Any, Protocol, TypeVar

from labeler.errors import HindsightError

Unit = TypeVar("Unit")
Result = TypeVar("Result")


class WorkerError(HindsightError):
    """A worker process died: killed from outside, or for lack of memory."""


class Executor(Protocol):
    """Runs units of work; a context manager that lets go of its workers at the end."""

    @property
    def workers(self) -> int:
        """How many units may run at the same time."""
        ...

    def run(self, work: Callable[[Unit], Result], units: Iterable[Unit], *, count: int) -> Iterator[Result]:
        """The results of ``work`` on each of ``count`` units, in their order. ``work`` and the units are picklable."""
        ...

    def __enter__(self) -> Executor: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


class SerialExecutor:
    """One unit after the other, in this process."""

    @property
    def workers(self) -> int:
        return 1

    def run(self, work: Callable[[Unit], Result], units: Iterable[Unit], *, count: int) -> Iterator[Result]:
        return map(work, units)

    def __enter__(self) -> SerialExecutor:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        return None


class ProcessesExecutor:
    """Units in worker processes, which start when there is first more than one unit to do.

    The workers are loky's: they start afresh (a fork of this process would copy its threads' locks), and unlike those
    of the standard library they don't run the caller's main module again, so scripts need no guard around theirs.
    """

    def __init__(self, workers: int | None = None) -> None:
        self._workers = workers or usable_cores()
        self._pool: Any = None

    @property
    def workers(self) -> int:
        return self._workers

    def run(self, work: Callable[[Unit], Result], units: Iterable[Unit], *, count: int) -> Iterator[Result]:
        if count <= 1 or self._workers == 1:
            return map(work, units)
        return self._run_in_pool(work, units)

    def _run_in_pool(self, work: Callable[[Unit], Result], units: Iterable[Unit]) -> Iterator[Result]:
        pool = self._start()
        running: deque[Future[Result]] = deque()
        try:
            for unit in units:
                running.append(pool.submit(work, unit))
                if len(running) > 2 * self._workers:
                    yield running.popleft().result()
            while running:
                yield running.popleft().result()
        except BrokenProcessPool as error:
            raise WorkerError(
                "A worker process died, perhaps for lack of memory. Run the same command again to resume, "
                "with --workers 1 if it happens again."
            ) from error

    def _start(self) -> Any:
        if self._pool is None:
            loky: Any = import_module("loky")  # it has no types of its own
            self._pool = loky.ProcessPoolExecutor(self._workers, initializer=_leave_interrupts_to_parent)
        return self._pool

    def __enter__(self) -> ProcessesExecutor:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._pool is not None:
            self._pool.shutdown(wait=True, kill_workers=error is not None)
            self._pool = None


def open_executor(name: str, *, workers: int | None = None) -> Executor:
    """The executor of that name: ``serial`` or ``processes``. HindsightError for any other."""
    if name == "serial":
        return SerialExecutor()
    if name == "processes":
        return ProcessesExecutor(workers)
    raise HindsightError(f"There is no executor {name!r}. Choose serial or processes.")


def usable_cores() -> int:
    """How many cores this process may use: its affinity where the system tells, else all of them."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _leave_interrupts_to_parent() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
