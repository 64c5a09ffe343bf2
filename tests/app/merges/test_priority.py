"""The order of the queue."""

import pytest

from app.merges.priority import priority, uncertainty_bits


@pytest.mark.parametrize(
    ("probability", "bits"),
    [
        (0.5, 1.0),  # a coin
        (0.25, 0.811278),  # -.25 lb .25 - .75 lb .75
        (0.75, 0.811278),  # the same question asked the other way round
        (0.0, 0.0),  # certain
        (1.0, 0.0),
    ],
)
def test_uncertainty(probability: float, bits: float) -> None:
    assert uncertainty_bits(probability) == pytest.approx(bits, abs=1e-6)


def test_ten_labels_at_a_coin_toss_come_before_twenty_that_are_almost_certain() -> None:
    assert priority(10, 0.5) == 10.0
    assert priority(20, 0.98) == pytest.approx(20 * 0.141441, abs=1e-3)
    assert priority(0, 0.5) == 0.0
    assert priority(5, 1.2) == 0.0  # a score beyond 1 is as certain as 1
