"""What an edit does, in terms of one labelling."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any


class EffectKind(StrEnum):
    """What can be done to a place. ``until_frame`` is the last frame that ``HIDE``, ``FILL`` and ``NO_DONOR`` are
    about, None where they are about the rest of the track."""

    CUT = "cut"
    """Here another track begins: ``made_track_id``."""
    HIDE = "hide"
    """The boxes from here on are not there."""
    BOX = "box"
    """A person drew the box: ``value.box``."""
    FILL = "fill"
    """The boxes between this frame and the last one lie on straight ways between known ones."""
    NO_DONOR = "no_donor"
    """The boxes from here on give their label to no other box."""
    NEW = "new"
    """The track as tracked is a person's own: ``value.camera``, ``value.class_name``."""
    SAME = "same"
    """This place and the other one show one object."""
    APART = "apart"
    """They show two."""
    OPEN = "open"
    """What was said of the two before holds no longer."""
    CLASS = "class"
    """The object is of ``value.class_name``."""
    MARK = "mark"
    """What is said of the object: ``value.mark``."""
    COMMENT = "comment"


SHAPING = (EffectKind.CUT, EffectKind.HIDE, EffectKind.BOX, EffectKind.FILL, EffectKind.NO_DONOR, EffectKind.NEW)
"""Kinds that change which boxes there are, which track they belong to, and which of them is the track's best."""
PAIRING = (EffectKind.SAME, EffectKind.APART, EffectKind.OPEN)
SAYING = (EffectKind.CLASS, EffectKind.MARK, EffectKind.COMMENT)


@dataclass(frozen=True)
class Place:
    """A frame of a track as tracked: whatever people split or join, it means the same."""

    tracked_id: int
    frame_index: int


@dataclass(frozen=True)
class Effect:
    """What an edit does to one place; two for the pairing kinds."""

    kind: EffectKind
    place: Place
    other: Place | None = None
    until_frame: int | None = None
    made_track_id: int | None = None
    value: Mapping[str, Any] = field(default_factory=dict[str, Any])

    def reaches(self, frame_index: int) -> bool:
        """Whether a frame lies between the place and ``until_frame``."""
        return self.place.frame_index <= frame_index and (self.until_frame is None or frame_index <= self.until_frame)


Box = tuple[float, float, float, float]
"""x1, y1, x2, y2 in pixels of the original image."""
