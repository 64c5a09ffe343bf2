"""Workers answer all at once, say what went wrong, and are gone at the end."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

pytest.importorskip("torch", reason="needs torch, of the extra `training`")

from labeler.training.errors import TrainingError
from labeler.training.workers import answers_ahead, open_workers


def test_every_worker_does_every_step_in_order() -> None:
    with open_workers(3, lambda worker, step: 10.0 * step + worker) as workers:
        for step in (0, 7):
            workers.ask(step)
        assert [list(workers.answers()) for _ in range(2)] == [[0.0, 1.0, 2.0], [70.0, 71.0, 72.0]]


def test_answers_come_ahead_in_order_however_large(tmp_path: Path) -> None:
    """More than a pipe holds: a worker goes on only when somebody receives."""

    def work(worker: int, step: int) -> NDArray[np.int64]:
        (tmp_path / f"{worker} did {step}").touch()
        return np.full(200_000, 10 * step + worker)

    with open_workers(2, work) as workers, answers_ahead(workers, range(3, 9), 2, np.concatenate) as batches:
        first = next(batches)
        assert (first[0], first[-1], len(first)) == (30, 31, 400_000)
        assert not (tmp_path / "0 did 6").exists()  # only two steps are under way
        assert [int(batch[0]) for batch in batches] == [40, 50, 60, 70, 80]


def test_what_a_worker_raises_ahead_is_raised_when_its_turn_comes() -> None:
    def work(worker: int, step: int) -> int:
        return 6 // (step - 2)

    with open_workers(1, work) as workers, answers_ahead(workers, range(5), 4, list) as batches:
        assert [next(batches), next(batches)] == [[-3], [-6]]
        with pytest.raises(ZeroDivisionError):
            next(batches)


def test_a_worker_whose_parent_was_killed_ends_in_the_middle_of_an_answer() -> None:
    script = (
        "import os, sys, signal\n"
        "from labeler.training.workers import open_workers\n"
        "def work(worker, step):\n"
        "    return bytes(10_000_000)\n"
        "with open_workers(2, lambda worker, step: os.getpid() if step == 0 else work(worker, step)) as workers:\n"
        "    workers.ask(0)\n"
        "    print(*workers.answers(), flush=True)\n"
        "    workers.ask(1)\n"
        "    os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    # Its output ends when the last process that may write to it is gone.
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, timeout=60, check=False)
    assert done.returncode == -signal.SIGKILL
    assert len(done.stdout.split()) == 2


def test_each_is_a_process_that_ends_with_the_block() -> None:
    with open_workers(2, lambda worker, step: os.getpid()) as workers:
        workers.ask(0)
        pids = list(workers.answers())
        assert os.getpid() not in pids
        assert len(set(pids)) == 2
    for pid in pids:
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)


def test_what_a_worker_raises_is_raised_here() -> None:
    def work(worker: int, step: int) -> float:
        if worker == 1:
            raise ValueError(f"no picture for step {step}")
        return 0.0

    with open_workers(2, work) as workers:
        workers.ask(4)
        with pytest.raises(ValueError, match="no picture for step 4"):
            workers.answers()


def test_a_worker_that_was_killed_is_said_to_be() -> None:
    def work(worker: int, step: int) -> float:
        os.kill(os.getpid(), signal.SIGKILL)
        return 0.0

    with open_workers(1, work) as workers:
        workers.ask(0)
        with pytest.raises(TrainingError, match="ended by the system"):
            workers.answers()
