"""The order in which merges are worth a person's look: how many labels are at stake, times how unsure the machine is.

The uncertainty is the entropy of the probability in bits: 1 where the machine might as well toss a coin, 0 where it is
sure. So ten labels at a coin toss come before twenty at which the machine is almost certain.
"""

import math


def uncertainty_bits(probability: float) -> float:
    """The entropy of a yes-or-no question whose answer is yes with this probability; 0..1."""
    return -sum(p * math.log2(p) for p in (probability, 1 - probability) if p > 0)


def priority(label_count: int, probability: float) -> float:
    """Labels at stake times bits of uncertainty; equal ones are told apart by the caller."""
    return round(label_count * uncertainty_bits(min(1.0, max(0.0, probability))), 4)
