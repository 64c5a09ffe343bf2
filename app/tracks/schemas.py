"""What the page learns about tracks and observations. Track and identity ids are the labeler's numbers in the drive."""

from enum import StrEnum

from pydantic import BaseModel, Field


class LabelSource(StrEnum):
    AUTO = "auto"
    PROPAGATED = "propagated"
    HUMAN = "human"


class WithheldReason(StrEnum):
    """Why an observation keeps its own label: its box probably shows something else than the track's object."""

    DOUBTFUL_BOX = "doubtful_box"


class LabelDonor(BaseModel):
    """The observation that a propagated label was taken from."""

    observation_id: int
    camera: str
    frame_index: int
    score: float | None


class Label(BaseModel):
    """What an observation is taken for; ``score`` is null where neither it nor its identity has one."""

    class_name: str
    score: float | None
    source: LabelSource
    donor: LabelDonor | None
    withheld: WithheldReason | None = Field(
        default=None, description="Why the observation did not get its identity's label; null where it did."
    )
    probability: float | None = Field(
        default=None,
        description="How likely class and box are right (IoU of at least .5); null where unknown, or a person's word.",
    )


class Observation(BaseModel):
    """A box of a track in one image; ``score`` is null where the tracker filled the box in."""

    id: int
    track_id: int
    identity_id: int
    camera: str
    box: tuple[float, float, float, float] = Field(description="x1, y1, x2, y2 in pixels of the original image.")
    class_name: str
    score: float | None
    filled: bool
    trust: float | None = Field(default=None, description="How likely the box shows the object that its track is of.")
    label: Label


class FrameObservations(BaseModel):
    frame_index: int
    observations: list[Observation]


class ObservationPage(BaseModel):
    """Observations of a run of frames; frames without any are listed too."""

    revision: int
    frames: list[FrameObservations]


class Track(BaseModel):
    id: int
    camera: str
    first_frame: int
    last_frame: int
    observation_count: int
    identity_id: int
    best_score: float | None = Field(description="Null where no observation of the track has a score.")
    best_frame: int
    class_name: str


class ScoreRuns(BaseModel):
    """When each track is seen, and how sure the detector was: see :mod:`app.tracks.runs`."""

    revision: int
    runs: dict[int, list[int]] = Field(
        description="By track id, three numbers a run: frames skipped since the run before, frames, and the mean score "
        "in tenths, 10 where all boxes are filled in."
    )
