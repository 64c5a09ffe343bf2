"""What the page learns about identities."""

from enum import StrEnum

from pydantic import BaseModel, Field


class IdentityDonor(BaseModel):
    """The best observation of an identity: its class and score are the identity's label."""

    observation_id: int
    track_id: int
    camera: str
    frame_index: int
    score: float | None = Field(description="Null where no observation of the identity has one.")


class IdentityMark(StrEnum):
    """What a person says of an object: looked at and right, or to be left out of what is exported."""

    REVIEWED = "reviewed"
    IGNORED = "ignored"


class Identity(BaseModel):
    """One object: its ``id`` is the smallest track id in it."""

    id: int
    class_name: str
    score: float | None
    camera_names: list[str]
    track_ids: list[int]
    first_frame: int
    last_frame: int
    observation_count: int
    propagated_count: int
    donor: IdentityDonor
    class_by_person: bool
    mark: IdentityMark | None
    comment_count: int
