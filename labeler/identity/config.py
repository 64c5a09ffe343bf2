"""Settings of the identity step."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class IdentityConfig:
    """When two 3D boxes are at the same place, and how sure a merge must be. Plain values, to be hashed as JSON.

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
                "IdentityConfig needs 0 <= propose_score <= accept_score <= 1, "
                f"got {self.propose_score} and {self.accept_score}"
            )
        if not 0 < self.min_similarity <= 1 or self.min_agreeing_frames < 1 or self.best_frames < 1:
            raise ValueError(
                "IdentityConfig needs 0 < min_similarity <= 1, min_agreeing_frames >= 1 and best_frames >= 1, "
                f"got {self.min_similarity}, {self.min_agreeing_frames} and {self.best_frames}"
            )
