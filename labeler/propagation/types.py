"""What the propagation step says: the label of every observation, and where it comes from."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum, StrEnum

import numpy as np
from numpy.typing import NDArray


class LabelSource(StrEnum):
    """Who said it: the detector on this very image, another observation of the same identity, or a person."""

    AUTO = "auto"
    PROPAGATED = "propagated"
    HUMAN = "human"


class Withheld(IntEnum):
    """Why an observation did not get its identity's label."""

    NO = 0
    """It did, or there is no donor."""

    DOUBTFUL_BOX = 1
    """Its box probably shows something else than the track's object, or too little of it."""


@dataclass(frozen=True)
class Donor:
    """The observation whose class and score become the label of others."""

    track_id: int
    camera: str
    frame_index: int
    class_id: int
    score: float


@dataclass(frozen=True)
class Votes:
    """What is kept of an identity's observations, to label all of them.

    ``best`` are those that may become donors, by slot of time (see :mod:`labeler.propagation.votes`), the best first;
    ``observation_count`` counts all, those without a score too; ``score_sums`` adds up the scores by camera and class.
    """

    best: dict[int, tuple[Donor, ...]]
    observation_count: int
    score_sums: dict[str, dict[int, float]]

    def class_share(self, class_id: int) -> float:
        """How much of the scores of all observations speaks for a class, from 0 to 1."""
        whole = sum(sum(of_camera.values()) for of_camera in self.score_sums.values())
        ours = sum(of_camera.get(class_id, 0.0) for of_camera in self.score_sums.values())
        return ours / whole if whole > 0 else 1.0

    def cameras_for(self, class_id: int) -> int:
        """In how many cameras no class has more of the scores than this one."""
        return sum(
            class_id in of_camera and of_camera[class_id] >= max(of_camera.values())
            for of_camera in self.score_sums.values()
        )


@dataclass(frozen=True, eq=False)
class Labels:
    """Labels of observations, a row each, in the order of the observations that they belong to.

    ``track_id``, ``frame_index`` (N,) int32 name the observation; ``identity_id`` (N,) int32 its identity (the smallest
    track id in it); ``class_id`` (N,) int16 and ``score`` (N,) float32 are the label; ``donor_track_id``,
    ``donor_frame_index`` (N,) int32 name the observation it was taken from; ``propagated`` (N,) bool is False where an
    observation is its own donor; ``withheld`` (N,) uint8 is a :class:`Withheld`, NO where it is left out;
    ``probability`` (N,) float32 is how likely the label is right (:mod:`labeler.propagation.probability`), NaN where
    the label has no score or it is left out.
    """

    track_id: NDArray[np.int32]
    frame_index: NDArray[np.int32]
    identity_id: NDArray[np.int32]
    class_id: NDArray[np.int16]
    score: NDArray[np.float32]
    donor_track_id: NDArray[np.int32]
    donor_frame_index: NDArray[np.int32]
    propagated: NDArray[np.bool_]
    withheld: NDArray[np.uint8] = field(default_factory=lambda: np.zeros(0, np.uint8))
    probability: NDArray[np.float32] = field(default_factory=lambda: np.zeros(0, np.float32))

    def __post_init__(self) -> None:
        if len(self.withheld) != len(self.track_id):
            object.__setattr__(self, "withheld", np.full(len(self.track_id), Withheld.NO, np.uint8))
        if len(self.probability) != len(self.track_id):
            object.__setattr__(self, "probability", np.full(len(self.track_id), np.nan, np.float32))

    def __len__(self) -> int:
        return len(self.track_id)
