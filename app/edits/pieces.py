"""Which track a place belongs to, now that people have split some."""

from bisect import bisect_right
from collections.abc import Iterable
from typing import NamedTuple

from app.edits.types import Place


class Span(NamedTuple):
    """The frames ``start <= frame_index < stop`` of a track as tracked are one track; None is without an end."""

    start: int
    stop: int | None
    track_id: int


class Cut(NamedTuple):
    """In this frame of a track as tracked another track begins."""

    tracked_id: int
    frame_index: int
    track_id: int


class Pieces:
    """The tracks that each track as tracked consists of."""

    def __init__(self, cuts: Iterable[Cut]) -> None:
        """Two people may have cut at the same frame: then both say the same."""
        found: dict[int, dict[int, int]] = {}
        for cut in cuts:
            found.setdefault(cut.tracked_id, {})[cut.frame_index] = cut.track_id
        self._cuts = {tracked: sorted(frames.items()) for tracked, frames in found.items()}

    def with_cuts(self, cuts: Iterable[tuple[Place, int]]) -> "Pieces":
        """As they would be with more cuts: places, and the tracks that begin there."""
        known = [Cut(tracked, frame, track) for tracked, here in self._cuts.items() for frame, track in here]
        return Pieces([*known, *(Cut(place.tracked_id, place.frame_index, track) for place, track in cuts)])

    def track_at(self, place: Place) -> int:
        """The track that a place belongs to. It may have no box left."""
        cuts = self._cuts.get(place.tracked_id, [])
        at = bisect_right(cuts, place.frame_index, key=lambda cut: cut[0])
        return cuts[at - 1][1] if at else place.tracked_id

    def spans(self, tracked_id: int) -> list[Span]:
        """The pieces of a track as tracked, in order."""
        cuts = self._cuts.get(tracked_id, [])
        starts = [(0, tracked_id), *cuts]
        stops = [frame for frame, _ in cuts] + [None]
        return [Span(start, stop, track) for (start, track), stop in zip(starts, stops, strict=True)]
