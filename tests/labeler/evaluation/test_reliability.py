"""Reliability, counted by hand."""

import numpy as np
import pytest

from labeler.evaluation.reliability import ReliabilityCounts


def test_labels_fall_into_steps() -> None:
    """Two labels said .25 of which one is right, four said .95 of which all are, one of 1 that is wrong."""
    counts = ReliabilityCounts()
    counts.add(np.array([0.25, 0.95, 0.95, np.nan]), np.array([True, True, True, True]))
    counts.add(np.array([0.25, 0.95, 0.95, 1.0]), np.array([False, True, True, False]))
    found = counts.reliability()
    assert found["labels"] == 7
    known = {one["start"]: one for one in found["bins"] if one["labels"]}
    assert set(known) == {0.2, 0.9}
    assert known[0.2] == {"start": 0.2, "stop": 0.3, "labels": 2, "predicted": 0.25, "observed": 0.5}
    assert known[0.9] == {"start": 0.9, "stop": 1.0, "labels": 5, "predicted": 0.96, "observed": 0.8}
    # .25 off in two labels, .16 in five
    assert found["expected_error"] == pytest.approx((2 * 0.25 + 5 * 0.16) / 7, abs=1e-4)


def test_without_labels_there_is_no_error() -> None:
    found = ReliabilityCounts().reliability()
    assert (found["labels"], found["expected_error"]) == (0, None)
    assert found["bins"][0] == {"start": 0.0, "stop": 0.1, "labels": 0, "predicted": None, "observed": None}
