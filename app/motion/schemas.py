"""What the page learns about how objects move."""

from pydantic import BaseModel, Field

from app.motion.checks import Check


class FailedCheck(BaseModel):
    """A physics check that an identity fails, at its worst in a frame."""

    check: Check
    value: float
    unit: str
    frame_index: int


class ObservationDistance(BaseModel):
    """How far an object was from the car, seen from above; null where its box has no 3D box there."""

    observation_id: int
    distance_m: float | None


class IdentityFacts(BaseModel):
    """What follows from an identity's boxes; distances are from the car, null without 3D boxes."""

    identity_id: int
    nearest_m: float | None
    farthest_m: float | None
    purity: float | None = Field(
        description="The share of its boxes that show the object that their track is of, as far as the tracker can "
        "judge; null where no box was judged."
    )
    failed: list[FailedCheck]
