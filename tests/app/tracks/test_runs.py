"""Observations of tracks as runs of one score."""

import numpy as np
import pytest

from app.tracks.runs import score_runs

NAN = float("nan")


@pytest.mark.parametrize(
    ("scores", "runs"),
    [
        # One observation: its own tenth; 0.3 belongs to the fourth.
        ({5: 0.3}, [5, 1, 3]),
        # A window of four has one mean: 0.55, whatever its single scores.
        ({0: 0.4, 1: 0.5, 2: 0.6, 3: 0.7}, [0, 4, 5]),
        # Two windows in one tenth are one run.
        (dict.fromkeys(range(2, 10), 0.81), [2, 8, 8]),
        # Two windows in two tenths are two runs, one after the other.
        (dict.fromkeys(range(4), 0.2) | dict.fromkeys(range(4, 6), 0.9), [0, 4, 2, 0, 2, 9]),
        # A filled-in box takes the score of its window; a window of such only has a level of its own.
        ({0: 0.5, 1: NAN, 2: 0.5, 3: 0.5}, [0, 4, 5]),
        ({0: 0.5, 1: 0.5, 2: 0.5, 3: 0.5, 4: NAN, 5: NAN}, [0, 4, 5, 0, 2, 10]),
        # A gap of three frames, inside a window and beyond.
        ({0: 0.5, 1: 0.5, 5: 0.5}, [0, 2, 5, 3, 1, 5]),
        # A perfect score is in the last tenth.
        ({0: 1.0}, [0, 1, 9]),
    ],
)
def test_runs_of_one_track(scores: dict[int, float], runs: list[int]) -> None:
    frames = np.array(list(scores))
    found = score_runs(np.full(len(frames), 7), frames, np.array(list(scores.values())))
    assert found == {7: runs}


def test_each_track_counts_from_the_start_of_the_drive() -> None:
    found = score_runs(np.array([1, 1, 2, 2]), np.array([3, 4, 2, 9]), np.array([0.5, 0.5, 0.5, 0.7]))
    assert found == {1: [3, 2, 5], 2: [2, 1, 5, 6, 1, 7]}


def test_no_tracks_no_runs() -> None:
    empty = np.zeros(0, np.int64)
    assert score_runs(empty, empty, np.zeros(0)) == {}
