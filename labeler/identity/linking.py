"""The cannot-link rule: two tracks of one camera that share a frame are two objects, and never one identity.

Not even by way of others: a merge joins whole components, so it is checked against all of their tracks. The machine's
merges and a person's go through the same :class:`IdentityGraph`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

SharesFrame = Callable[[int, int], bool]


class CannotLinkError(ValueError):
    """A merge was asked for that would put two tracks of one camera that share a frame into one identity.

    ``track_a`` and ``track_b`` are those two tracks; they need not be the ones that were to be merged.
    """

    def __init__(self, track_a: int, track_b: int, camera: str) -> None:
        super().__init__(
            f"tracks {track_a} and {track_b} stand in the same frame of camera {camera}, so they are two objects; "
            "undo the merge that leads to one of them first"
        )
        self.track_a = track_a
        self.track_b = track_b
        self.camera = camera


class IdentityGraph:
    """Tracks, and the merges made so far. An identity is a connected component; its id is its smallest track id."""

    def __init__(self, cameras: Mapping[int, str], share_frame: SharesFrame) -> None:
        """``cameras`` gives the camera of every track. ``share_frame(track_a, track_b)`` says whether two tracks of one
        camera stand in the same frame; it is asked about no others."""
        self._cameras = dict(cameras)
        self._share_frame = share_frame
        self._identity = {track: track for track in self._cameras}
        self._members: dict[int, list[int]] = {track: [track] for track in self._cameras}

    def identity_of(self, track: int) -> int:
        """The identity of a track; KeyError for a track that the graph does not have."""
        return self._identity[track]

    def members(self, track: int) -> tuple[int, ...]:
        """All tracks of the identity that a track belongs to, in ascending order."""
        return tuple(sorted(self._members[self._identity[track]]))

    def identities(self) -> dict[int, int]:
        """The identity of every track."""
        return dict(self._identity)

    def conflict(self, track_a: int, track_b: int) -> tuple[int, int] | None:
        """The two tracks that forbid a merge, the first from ``track_a``'s identity, or None when it is allowed."""
        if self._identity[track_a] == self._identity[track_b]:
            return None
        others: dict[str, list[int]] = {}
        for other in self.members(track_b):
            others.setdefault(self._cameras[other], []).append(other)
        for track in self.members(track_a):
            for other in others.get(self._cameras[track], ()):
                if self._share_frame(track, other):
                    return track, other
        return None

    def join(self, track_a: int, track_b: int) -> int:
        """Make two tracks one identity and return its id. Raises CannotLinkError when the rule forbids it."""
        forbidden = self.conflict(track_a, track_b)
        if forbidden is not None:
            raise CannotLinkError(*forbidden, self._cameras[forbidden[0]])
        kept, gone = sorted((self._identity[track_a], self._identity[track_b]))
        if kept != gone:
            moved = self._members.pop(gone)
            self._members[kept] += moved
            for track in moved:
                self._identity[track] = kept
        return kept


def components(tracks: Iterable[int], pairs: Iterable[tuple[int, int]]) -> dict[int, int]:
    """The smallest track id of the component of every track, joined by ``pairs``; no rule is checked."""
    graph = IdentityGraph(dict.fromkeys(tracks, ""), lambda _a, _b: False)
    for track_a, track_b in pairs:
        graph.join(track_a, track_b)
    return graph.identities()


class SharedFrames:
    """Which tracks of one camera have stood in the same frame: a set of pairs, filled frame by frame."""

    def __init__(self) -> None:
        self._pairs: set[tuple[int, int]] = set()
        self._present: dict[str, frozenset[int]] = {}

    def add(self, camera: str, tracks: Iterable[int]) -> None:
        """These tracks stand in one frame of a camera."""
        present = frozenset(tracks)
        before = self._present.get(camera, frozenset())
        for new in present - before:
            self._pairs.update((min(new, other), max(new, other)) for other in present if other != new)
        self._present[camera] = present

    def pairs(self) -> frozenset[tuple[int, int]]:
        """All pairs, the smaller track first."""
        return frozenset(self._pairs)

    def __call__(self, track_a: int, track_b: int) -> bool:
        return (min(track_a, track_b), max(track_a, track_b)) in self._pairs
