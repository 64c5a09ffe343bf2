"""Worker processes, each on one core, that compute gradients or make examples.

Threads would be simpler, but a small network's step is thousands of small operations, and two threads spend half of it
waiting for Python's interpreter lock. The processes are forked, so the pictures are in memory once. Where the system
has no fork (Windows), threads do the same work.
"""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

import multiprocessing
import signal
import warnings
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from itertools import islice
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from multiprocessing.reduction import ForkingPickler
from typing import Protocol, TypeVar, cast

import cv2
import torch

from labeler.training.errors import TrainingError

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)
U = TypeVar("U")


class Workers(Protocol[T_co]):
    """Workers that all do the same steps, in the order in which they are asked to."""

    def ask(self, step: int) -> None:
        """Have all do a step, now or after those that they were asked for before."""
        ...

    def answers(self) -> Sequence[T_co]:
        """What each made of the step that was asked for longest ago. What a worker raised, it raises; TrainingError
        when a worker was ended from outside."""
        ...


@contextmanager
def open_workers(count: int, work: Callable[[int, int], T]) -> Generator[Workers[T]]:
    """``count`` workers that do ``work``: a worker's number and a step to an answer. They end with the context."""
    with ExitStack() as stack:
        if "fork" in multiprocessing.get_all_start_methods():
            connections: list[Connection] = []
            for number in range(count):
                connections.append(stack.enter_context(_forked(number, work, connections)))
            yield _Processes[T](connections)
        else:
            yield _Threads(stack.enter_context(ThreadPoolExecutor(count)), count, work)


class _Processes(Workers[T]):
    def __init__(self, connections: Sequence[Connection]) -> None:
        self._connections = connections

    def ask(self, step: int) -> None:
        for connection in self._connections:
            try:
                connection.send(step)
            except OSError as error:
                raise _ended() from error

    def answers(self) -> Sequence[T]:
        answers = [_answer(connection) for connection in self._connections]
        for answer in answers:
            if isinstance(answer, Exception):
                raise answer
        return cast("list[T]", answers)


class _Threads(Workers[T]):
    def __init__(self, pool: ThreadPoolExecutor, count: int, work: Callable[[int, int], T]) -> None:
        self._pool, self._count, self._work = pool, count, work
        self._asked: deque[list[Future[T]]] = deque()

    def ask(self, step: int) -> None:
        self._asked.append([self._pool.submit(self._work, number, step) for number in range(self._count)])

    def answers(self) -> Sequence[T]:
        return [answer.result() for answer in self._asked.popleft()]


@contextmanager
def answers_ahead(
    workers: Workers[T], steps: range, ahead: int, made_of: Callable[[Sequence[T]], U]
) -> Generator[Iterator[U]]:
    """What is ``made_of`` the workers' answers to each of ``steps`` in turn. They work up to ``ahead`` steps in
    advance; a thread receives what they made, so that they need not wait for whoever wants it."""
    with ThreadPoolExecutor(1) as pool:
        to_come, coming = iter(steps), deque[Future[U]]()

        def begin(count: int) -> None:
            for step in islice(to_come, count):
                workers.ask(step)
                coming.append(pool.submit(lambda: made_of(workers.answers())))

        def made() -> Iterator[U]:
            begin(ahead)
            while coming:
                next_one = coming.popleft().result()
                begin(1)
                yield next_one

        try:
            yield made()
        finally:
            for future in coming:
                future.cancel()


@contextmanager
def _forked(number: int, work: Callable[[int, int], object], older: Sequence[Connection]) -> Generator[Connection]:
    """The connection to a worker process, which ends with the context. ``older`` lead to those that are there."""
    context = multiprocessing.get_context("fork")
    here, there = context.Pipe()
    process: BaseProcess = context.Process(target=_serve, args=(number, work, there, (*older, here)), daemon=True)
    with warnings.catch_warnings():  # Python warns of forks beside threads; the child uses none of theirs
        warnings.simplefilter("ignore", DeprecationWarning)
        process.start()
    there.close()
    try:
        yield here
    finally:
        process.kill()
        process.join()
        here.close()


def _serve(
    number: int, work: Callable[[int, int], object], connection: Connection, of_parent: Sequence[Connection]
) -> None:
    """In the child: do steps until the parent is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides when to stop
    torch.set_num_threads(1)
    cv2.setNumThreads(0)  # its threads stayed in the parent
    for copied in of_parent:  # while any process holds the parent's end open, nobody sees that the parent is gone
        copied.close()
    try:
        while True:
            step = connection.recv()
            try:
                answer = ForkingPickler.dumps(work(number, step))
            except Exception as error:  # whatever it is, the parent raises it
                answer = ForkingPickler.dumps(error)
            connection.send_bytes(answer)
    except (EOFError, OSError):
        return


def _answer(connection: Connection) -> object:
    try:
        return connection.recv()
    except (EOFError, OSError) as error:
        raise _ended() from error


def _ended() -> TrainingError:
    return TrainingError(
        "A worker process was ended by the system, probably for want of memory. Use fewer --workers or drives; "
        "the same command goes on from the last checkpoint."
    )
