"""Settings of the propagation step."""

from __future__ import annotations

from dataclasses import dataclass

from labeler.propagation.errors import PropagationError


@dataclass(frozen=True)
class PropagationConfig:
    """Plain values, so that the step's artifact can be keyed by them. The default is the paper's own rule."""

    min_donor_score: float = 0.0
    """An observation with a score below this one gives its label to no other."""

    def __post_init__(self) -> None:
        if not 0 <= self.min_donor_score <= 1:
            raise PropagationError(
                f"Propagation setting min_donor_score must be from 0 to 1, got {self.min_donor_score}."
            )
