"""The settings refuse what makes no sense."""

import pytest

from labeler.propagation import PropagationConfig, PropagationError


@pytest.mark.parametrize("score", [-0.1, 1.1, float("nan")])
def test_refuses_a_score_outside_0_to_1(score: float) -> None:
    with pytest.raises(PropagationError, match="min_donor_score"):
        PropagationConfig(min_donor_score=score)
