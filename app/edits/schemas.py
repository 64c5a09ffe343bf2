"""What the page sends to correct labels, and what it learns of corrections."""

from datetime import datetime
from enum import StrEnum
from typing import Annotated, Literal

from pydantic import BaseModel, Field, model_validator

from app.identities.schemas import IdentityMark

Identities = Annotated[list[int], Field(min_length=1, max_length=2_000)]
FrameIndex = Annotated[int, Field(ge=0)]


class EditAction(StrEnum):
    """What a decision does. The first are about a merge, the last two about another decision."""

    ACCEPT = "accept"
    REJECT = "reject"
    UNSURE = "unsure"
    UNDO = "undo"
    CLASS = "class"
    SPLIT = "split"
    JOIN = "join"
    SWAP = "swap"
    DELETE = "delete"
    BOX = "box"
    INTERPOLATE = "interpolate"
    DONOR = "donor"
    MARK = "mark"
    COMMENT = "comment"
    UNDO_EDIT = "undo_edit"
    REDO_EDIT = "redo_edit"


class ClassEdit(BaseModel):
    """The objects are of this class, one that the labelling has."""

    kind: Literal["class"]
    identity_ids: Identities
    class_name: str


class SplitEdit(BaseModel):
    """In this frame another object begins in each of the tracks."""

    kind: Literal["split"]
    track_ids: Identities
    frame_index: FrameIndex


class JoinEdit(BaseModel):
    """The identities are one object."""

    kind: Literal["join"]
    identity_ids: Annotated[list[int], Field(min_length=2, max_length=2_000)]


class SwapEdit(BaseModel):
    """From this frame on each of the two identities is the other one, in all cameras and in 3D."""

    kind: Literal["swap"]
    identity_ids: Annotated[list[int], Field(min_length=2, max_length=2)]
    frame_index: FrameIndex


class ObservationPlace(BaseModel):
    track_id: int
    frame_index: FrameIndex


class DeleteEdit(BaseModel):
    """There is no such object, track or box."""

    kind: Literal["delete"]
    identity_ids: list[int] = Field(default=[], max_length=2_000)
    track_ids: list[int] = Field(default=[], max_length=2_000)
    observations: list[ObservationPlace] = Field(default=[], max_length=2_000)

    @model_validator(mode="after")
    def _require_something(self) -> "DeleteEdit":
        if not (self.identity_ids or self.track_ids or self.observations):
            raise ValueError("name at least one identity, track or observation")
        return self


class BoxEdit(BaseModel):
    """A box as a person draws it: of a track, else of an identity in a camera, else of a new object of a class.

    With ``interpolate`` the frames between it and the next ones of its track that a person drew get boxes, where they
    have none.
    """

    kind: Literal["box"]
    camera: str
    frame_index: FrameIndex
    box: tuple[float, float, float, float] = Field(description="x1, y1, x2, y2 in pixels of the original image.")
    track_id: int | None = None
    identity_id: int | None = None
    class_name: str | None = None
    interpolate: bool = True


class InterpolateEdit(BaseModel):
    """Between two frames of a track its boxes lie on straight ways from the one to the other."""

    kind: Literal["interpolate"]
    track_id: int
    first_frame: FrameIndex
    last_frame: FrameIndex


class DonorEdit(BaseModel):
    """The identity is not to take its label from this observation, or from none of its track: it is propagated anew."""

    kind: Literal["donor"]
    identity_id: int
    track_id: int
    frame_index: FrameIndex
    whole_track: bool = False


class MarkChoice(StrEnum):
    REVIEWED = IdentityMark.REVIEWED.value
    IGNORED = IdentityMark.IGNORED.value
    OPEN = "open"


class MarkEdit(BaseModel):
    """The objects were looked at, are to be left out of what is exported, or neither."""

    kind: Literal["mark"]
    identity_ids: Identities
    mark: MarkChoice


class CommentEdit(BaseModel):
    kind: Literal["comment"]
    identity_ids: Identities
    text: Annotated[str, Field(min_length=1, max_length=4_000)]


AnyEdit = Annotated[
    ClassEdit
    | SplitEdit
    | JoinEdit
    | SwapEdit
    | DeleteEdit
    | BoxEdit
    | InterpolateEdit
    | DonorEdit
    | MarkEdit
    | CommentEdit,
    Field(discriminator="kind"),
]

Revision = Annotated[
    int | None,
    Field(
        ge=0, description="The revision that the page had read; refused (409, stale) where the same objects changed."
    ),
]


class EditRequest(BaseModel):
    """One correction, of however many objects: one step of undo."""

    edit: AnyEdit
    revision: Revision = None


class UndoRequest(BaseModel):
    """``edit_id`` names a decision; without it, the reviewer's latest one that is not undone (or that is, to redo)."""

    edit_id: int | None = None
    revision: Revision = None


class Edit(BaseModel):
    """A decision of a person, as it was made; numbers of objects and tracks are those of that time."""

    id: int
    action: EditAction
    reviewer: str
    created_at: datetime
    undone: bool
    target_id: int | None = Field(description="The decision that was undone or made again.")
    revision: int
    identity_ids: list[int] = []
    track_ids: list[int] = []
    frame_index: int | None = None
    until_frame: int | None = None
    camera: str | None = None
    class_name: str | None = None
    mark: MarkChoice | None = None
    text: str | None = None


class EditPage(BaseModel):
    """Decisions, newest first. ``next_before`` asks for older ones; null at the end."""

    edits: list[Edit]
    next_before: int | None
    undo: Edit | None = Field(description="What undoing would take back for this reviewer.")
    redo: Edit | None = Field(description="What redoing would make again.")


class Comment(BaseModel):
    edit_id: int
    identity_id: int
    text: str
    reviewer: str
    created_at: datetime


class DriveRevision(BaseModel):
    """Sent whenever the drive's labels changed; ``edit`` is the latest decision, null before the first."""

    revision: int
    edit: Edit | None
