"""The settings refuse what makes no sense."""

from typing import Any

import pytest

from labeler.propagation import PropagationConfig, PropagationError


@pytest.mark.parametrize("score", [-0.1, 1.1, float("nan")])
def test_refuses_a_score_outside_0_to_1(score: float) -> None:
    with pytest.raises(PropagationError, match="min_donor_score"):
        PropagationConfig(min_donor_score=score)


@pytest.mark.parametrize(
    ("given", "named"),
    [
        ({"rule": "best"}, "rule 'best'"),
        ({"top_k": 0}, "top_k"),
        ({"window_s": -1.0}, "window_s"),
        ({"window_s": float("nan")}, "window_s"),
        ({"window_s": float("inf")}, "window_s"),
    ],
)
def test_refuses_what_makes_no_sense(given: dict[str, Any], named: str) -> None:
    with pytest.raises(PropagationError, match=named):
        PropagationConfig(**given)
