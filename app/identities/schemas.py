"""What the page learns about identities."""

from pydantic import BaseModel


class IdentityDonor(BaseModel):
    """The best observation of an identity: its class and score are the identity's label."""

    observation_id: int
    track_id: int
    camera: str
    frame_index: int
    score: float


class Identity(BaseModel):
    """One object: its ``id`` is the smallest track id in it."""

    id: int
    class_name: str
    score: float
    camera_names: list[str]
    track_ids: list[int]
    first_frame: int
    last_frame: int
    observation_count: int
    propagated_count: int
    donor: IdentityDonor
