"""Workers answer all at once, say what went wrong, and are gone at the end."""

import os
import signal

import pytest

pytest.importorskip("torch", reason="needs torch, of the extra `training`")

from labeler.training.errors import TrainingError
from labeler.training.workers import open_workers


def test_every_worker_does_every_step_in_order() -> None:
    with open_workers(3, lambda worker, step: 10.0 * step + worker) as do:
        assert [list(do(step)) for step in (0, 7)] == [[0.0, 1.0, 2.0], [70.0, 71.0, 72.0]]


def test_each_is_a_process_that_ends_with_the_block() -> None:
    with open_workers(2, lambda worker, step: float(os.getpid())) as do:
        pids = [int(pid) for pid in do(0)]
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

    with pytest.raises(ValueError, match="no picture for step 4"), open_workers(2, work) as do:
        do(4)


def test_a_worker_that_was_killed_is_said_to_be() -> None:
    def work(worker: int, step: int) -> float:
        os.kill(os.getpid(), signal.SIGKILL)
        return 0.0

    with pytest.raises(TrainingError, match="ended by the system"), open_workers(1, work) as do:
        do(0)
