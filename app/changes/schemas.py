"""What the page learns of a decision."""

from pydantic import BaseModel, Field

from app.edits.schemas import Edit
from app.identities.schemas import Identity
from app.merges.schemas import Merge
from app.tracks.schemas import FrameObservations, Track


class LabelChange(BaseModel):
    """What a decision changed.

    A page that had read everything as it was at ``revision`` - 1 has it as it is now with what is in here."""

    revision: int
    changed_label_count: int
    identity_ids: list[int]
    identities: list[Identity] = Field(description="All that the decision reached, as they are now.")
    gone_identity_ids: list[int] = Field(description="Identities whose tracks are in others now.")
    tracks: list[Track] = Field(description="All tracks of these identities, as they are now.")
    merges: list[Merge] = Field(description="All merges of these tracks, as they are now.")
    changed_track_ids: list[int] = Field(
        description="Tracks that are of another identity now, or of which a label or a box changed; those that are no "
        "more among them."
    )
    observations: list[FrameObservations] | None = Field(
        description="By frame, all that the changed tracks have now; null where there are too many: load them anew."
    )


class MergeChange(LabelChange):
    """What a decision about a merge changed; ``identity_ids`` are the identities that its tracks are in afterwards."""

    merge: Merge


class EditChange(LabelChange):
    """What a correction changed; ``identity_ids`` are the identities that its tracks are in afterwards."""

    edit: Edit
