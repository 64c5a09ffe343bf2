"""Settings of the identity step."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from labeler.identity.smoothing import MotionConfig

ASSIGNMENT, BASELINE = "assignment", "baseline"
METHODS = (ASSIGNMENT, BASELINE)


@dataclass(frozen=True)
class Algorithm2Config:
    """The paper's Algorithm 2: when two 3D boxes are at the same place, and how sure a merge must be.

    ``min_similarity``: at least so similar (see :func:`labeler.identity.overlap.compare_boxes`) are boxes at the same
    place. ``accept_score``: from this score on a merge is made; ``propose_score``: from this one on it is proposed to a
    person. ``min_agreeing_frames``: with boxes at the same place in fewer frames a merge is only proposed, however
    similar they are: once may be chance. ``best_frames``: how many frames of evidence are kept for a merge.
    """

    min_similarity: float = 0.3
    accept_score: float = 0.5
    propose_score: float = 0.2
    min_agreeing_frames: int = 2
    best_frames: int = 3

    def __post_init__(self) -> None:
        if not 0 <= self.propose_score <= self.accept_score <= 1:
            raise ValueError(
                "Algorithm2Config needs 0 <= propose_score <= accept_score <= 1, "
                f"got {self.propose_score} and {self.accept_score}"
            )
        if not 0 < self.min_similarity <= 1 or self.min_agreeing_frames < 1 or self.best_frames < 1:
            raise ValueError(
                "Algorithm2Config needs 0 < min_similarity <= 1, min_agreeing_frames >= 1 and best_frames >= 1, "
                f"got {self.min_similarity}, {self.min_agreeing_frames} and {self.best_frames}"
            )


@dataclass(frozen=True)
class IdentityConfig:
    """How tracks become identities. Plain values, to be hashed as JSON.

    ``method``: ``assignment`` weighs all evidence of all pairs at once; ``baseline`` is the paper's Algorithm 2.
    ``accept_probability``: a merge that is at least so probable is made; ``propose_probability``: one that is at least
    so probable is proposed to a person. ``max_gap_s``: how long an object may be out of sight and still be found again.
    ``max_still_gap_s``: likewise for one that stands. ``best_frames``: how many frames of evidence a merge keeps.
    """

    method: str = ASSIGNMENT
    accept_probability: float = 0.85
    propose_probability: float = 0.5
    max_gap_s: float = 6.0
    max_still_gap_s: float = 15.0
    best_frames: int = 3
    motion: MotionConfig = field(default_factory=MotionConfig)
    algorithm_2: Algorithm2Config = field(default_factory=Algorithm2Config)

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            raise ValueError(f"There is no identity method {self.method!r}. Choose one of: {', '.join(METHODS)}.")
        if not 0 < self.propose_probability <= self.accept_probability < 1 or self.accept_probability < 0.5:
            raise ValueError(
                "IdentityConfig needs 0 < propose_probability <= accept_probability < 1 and accept_probability >= 0.5, "
                f"got {self.propose_probability} and {self.accept_probability}"
            )
        if not 0 <= self.max_gap_s <= self.max_still_gap_s or self.best_frames < 1:
            raise ValueError(
                "IdentityConfig needs 0 <= max_gap_s <= max_still_gap_s and best_frames >= 1, "
                f"got {self.max_gap_s}, {self.max_still_gap_s} and {self.best_frames}"
            )

    def with_method(self, method: str) -> IdentityConfig:
        """The same settings with another method."""
        return replace(self, method=method)
