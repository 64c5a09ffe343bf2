"""Which boxes a track has after edits: the machine's, drawn ones, and those on straight ways between known ones."""

from bisect import bisect_left
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

from app.edits.types import Box, EffectKind


@dataclass(frozen=True)
class BoxEdit:
    """An effect of the kinds hide, box or fill; ``until_frame`` None reaches to the end of the track."""

    kind: EffectKind
    frame_index: int
    until_frame: int | None = None
    box: Box | None = None


@dataclass(frozen=True)
class DrawnBox:
    """A box that a person made; ``filled`` where it lies between known ones."""

    box: Box
    filled: bool


@dataclass
class Boxes:
    """The machine's boxes that stay, and those that people made, by frame."""

    kept: set[int]
    drawn: dict[int, DrawnBox] = field(default_factory=dict[int, DrawnBox])


def edited_boxes(machine: Mapping[int, Box], edits: Sequence[BoxEdit], frames: Collection[int]) -> Boxes:
    """The boxes of a track after ``edits``, in their order. Boxes are made only in ``frames``, those with an image.

    A filled frame between two known boxes gets the box at its share of the way between them. One that has a known box
    on one side only gets none, and keeps the machine's.
    """
    hidden: set[int] = set()
    keyframes: dict[int, Box] = {}
    filled: set[int] = set()
    last = max([*machine, *(edit.frame_index for edit in edits)], default=-1)
    for edit in edits:
        if edit.kind is EffectKind.BOX:
            assert edit.box is not None
            keyframes[edit.frame_index] = edit.box
            filled.discard(edit.frame_index)
            continue
        reach = range(edit.frame_index, (last if edit.until_frame is None else edit.until_frame) + 1)
        if edit.kind is EffectKind.HIDE:
            hidden.update(reach)
            filled.difference_update(reach)
            for frame in [frame for frame in keyframes if frame in reach]:
                del keyframes[frame]
        else:
            filled.update(frame for frame in reach[1:-1] if frame not in keyframes)
    known = {frame: box for frame, box in machine.items() if frame not in hidden and frame not in filled} | keyframes
    boxes = Boxes(
        kept={frame for frame in machine if frame not in hidden and frame not in keyframes},
        drawn={frame: DrawnBox(box, filled=False) for frame, box in keyframes.items()},
    )
    order = sorted(known)
    for frame in sorted(filled & set(frames)):
        at = bisect_left(order, frame)
        if 0 < at < len(order):
            boxes.drawn[frame] = DrawnBox(_between(known, order[at - 1], order[at], frame), filled=True)
            boxes.kept.discard(frame)
    return boxes


def _between(known: Mapping[int, Box], before: int, after: int, frame: int) -> Box:
    share = (frame - before) / (after - before)
    x1, y1, x2, y2 = (round(a + (b - a) * share, 2) for a, b in zip(known[before], known[after], strict=True))
    return (x1, y1, x2, y2)
