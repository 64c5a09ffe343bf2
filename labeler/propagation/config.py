"""Settings of the propagation step."""

from __future__ import annotations

from dataclasses import dataclass, fields

from labeler.propagation.errors import PropagationError


@dataclass(frozen=True)
class PropagationConfig:
    """Plain values, so that the step's artifact can be keyed by them. The paper's own rule is ``min_trust=0``."""

    min_donor_score: float = 0.0
    """An observation with a score below this one gives its label to no other."""

    min_trust: float = 0.13
    """An observation that shows its track's object with less probability than this keeps its own label; 0 keeps none
    back, as in the paper."""

    def __post_init__(self) -> None:
        for field in fields(self):
            value: float = getattr(self, field.name)
            if not 0 <= value <= 1:
                raise PropagationError(f"Propagation setting {field.name} must be from 0 to 1, got {value}.")
