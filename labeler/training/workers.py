"""Worker processes that compute gradients, each on one core, with its own copy of the network in shared memory.

Threads would be simpler, but a small network's step is thousands of small operations, and two threads spend half of it
waiting for Python's interpreter lock. The processes are forked, so the pictures are in memory once. Where the system
has no fork (Windows), threads do the same work.
"""

# pyright: reportUnknownMemberType=false
# torch leaves parts of its types open.

from __future__ import annotations

import multiprocessing
import os
import signal
import warnings
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess

import cv2
import torch

from labeler.training.errors import TrainingError

Work = Callable[[int, int], float]
"""What a worker does in a step: (worker's number, step) to the loss."""


@contextmanager
def open_workers(count: int, work: Work) -> Generator[Callable[[int], Sequence[float]]]:
    """A function that does a step by all workers at once, and gives their losses. What ``work`` raises, it raises;
    TrainingError when a worker was ended from outside."""
    if "fork" not in multiprocessing.get_all_start_methods():
        with ThreadPoolExecutor(count) as pool:
            yield lambda step: list(pool.map(work, range(count), [step] * count))
        return
    with ExitStack() as stack:
        workers = [stack.enter_context(_forked(number, work)) for number in range(count)]

        def do(step: int) -> Sequence[float]:
            for connection in workers:
                connection.send(step)
            answers = [_answer(connection) for connection in workers]
            for answer in answers:
                if isinstance(answer, Exception):
                    raise answer
            return [answer for answer in answers if isinstance(answer, float)]

        yield do


@contextmanager
def _forked(number: int, work: Work) -> Generator[Connection]:
    """The connection to a worker process, which ends with the context."""
    context = multiprocessing.get_context("fork")
    here, there = context.Pipe()
    process: BaseProcess = context.Process(target=_serve, args=(number, work, there), daemon=True)
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


def _serve(number: int, work: Work, connection: Connection) -> None:
    """In the child: do steps until the parent is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides when to stop
    torch.set_num_threads(1)
    cv2.setNumThreads(0)  # its threads stayed in the parent
    parent = os.getppid()
    while os.getppid() == parent:
        if not connection.poll(1.0):
            continue
        step = connection.recv()
        try:
            connection.send(work(number, step))
        except Exception as error:  # whatever it is, the parent raises it
            connection.send(error)


def _answer(connection: Connection) -> object:
    try:
        return connection.recv()
    except EOFError as error:
        raise TrainingError(
            "A worker process was ended by the system, probably for want of memory. Use fewer --workers or drives; "
            "the same command goes on from the last checkpoint."
        ) from error
