"""Settings of the propagation step."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from labeler.propagation.errors import PropagationError

RULES = ("highest", "top-k")


@dataclass(frozen=True)
class PropagationConfig:
    """Plain values, so that the step's artifact can be keyed by them. The paper's own rule is ``min_trust=0``."""

    rule: str = "highest"
    """Whose label all get: ``highest`` is the paper's, the observation with the highest score; in ``top-k`` the
    ``top_k`` best vote by their scores, and the best of the class that wins is the donor."""

    top_k: int = 5
    """How many observations vote (top-k only)."""

    window_s: float = 0.0
    """A donor is less than this many seconds away from an observation; 0 takes donors from any time."""

    min_donor_score: float = 0.0
    """An observation with a score below this one gives its label to no other."""

    min_trust: float = 0.45
    """An observation that shows its track's object with less probability than this keeps its own label; 0 keeps none
    back, as in the paper."""

    def __post_init__(self) -> None:
        if self.rule not in RULES:
            raise PropagationError(f"There is no propagation rule {self.rule!r}. Choose one of: {', '.join(RULES)}.")
        if self.top_k < 1:
            raise PropagationError(f"Propagation setting top_k must be at least 1, got {self.top_k}.")
        if not (math.isfinite(self.window_s) and self.window_s >= 0):
            raise PropagationError(
                f"Propagation setting window_s must be a number of seconds above 0, or 0 for any, got {self.window_s}."
            )
        for name in ("min_donor_score", "min_trust"):
            value: float = getattr(self, name)
            if not 0 <= value <= 1:
                raise PropagationError(f"Propagation setting {name} must be from 0 to 1, got {value}.")

    @property
    def voters(self) -> int:
        """How many observations have a say in a label."""
        return self.top_k if self.rule == "top-k" else 1


_SMALL_DETECTOR_BYTES = 8_000_000
_MIN_TRUST_OF_SMALL = 0.25


def usual_min_trust(detector: Path) -> float:
    """The ``min_trust`` for a detector, by the size of its model file; that of large ones where there is no such file.

    A threshold is best where it is half of the F1 that can be reached (Lipton, Elkan and Naryanaswamy, Optimal
    thresholding of classifiers to maximize F1 measure, ECML 2014), and small networks reach less."""
    is_small = detector.is_file() and detector.stat().st_size < _SMALL_DETECTOR_BYTES
    return _MIN_TRUST_OF_SMALL if is_small else PropagationConfig.min_trust
