"""Executors give every result once, in order, and pass errors on."""

import os

import pytest

from labeler.errors import HindsightError
from labeler.pipeline.executors import ProcessesExecutor, SerialExecutor, open_executor, usable_cores


def _square(number: int) -> tuple[int, int]:
    return number * number, os.getpid()


def _fail_on_three(number: int) -> int:
    if number == 3:
        raise HindsightError("three is broken")
    return number


def _die(number: int) -> int:
    os._exit(1)


@pytest.mark.parametrize("name", ["serial", "processes"])
def test_results_come_in_the_order_of_the_units(name: str) -> None:
    with open_executor(name, workers=2) as executor:
        results = list(executor.run(_square, range(20), count=20))
    assert [square for square, _ in results] == [number * number for number in range(20)]
    in_this_process = {pid == os.getpid() for _, pid in results}
    assert in_this_process == {name == "serial"}


def test_one_unit_starts_no_worker() -> None:
    with ProcessesExecutor(2) as executor:
        assert list(executor.run(_square, [3], count=1)) == [(9, os.getpid())]


def test_an_error_of_a_unit_reaches_the_caller() -> None:
    with ProcessesExecutor(2) as executor, pytest.raises(HindsightError, match="three is broken"):
        list(executor.run(_fail_on_three, range(6), count=6))


def test_a_worker_that_dies_is_named_and_told_how_to_go_on() -> None:
    with ProcessesExecutor(2) as executor, pytest.raises(HindsightError, match="Run the same command again"):
        list(executor.run(_die, range(6), count=6))


def test_an_unknown_executor_is_refused() -> None:
    with pytest.raises(HindsightError, match="Choose serial or processes"):
        open_executor("cluster")


def test_cores_are_counted() -> None:
    assert 1 <= usable_cores() <= (os.cpu_count() or 1)
    assert SerialExecutor().workers == 1
