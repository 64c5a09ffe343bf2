"""How many labels a decision about a merge changes.

Accepting joins two identities: the labels of the one with the lesser best observation change. Rejecting a merge that
holds splits an identity: the labels of the part without the best observation change.
"""

from collections.abc import Iterable, Sequence

from app.identities.linking import best_track
from app.merges.models import MergeRow
from app.merges.repository import StoredMerge
from app.tracks.models import TrackRow
from app.tracks.repository import TrackFacts
from labeler.identity.linking import IdentityGraph

AnyTrack = TrackRow | TrackFacts


class Impact:
    """Counts for the merges of one labelling. ``accepted`` are all merges that hold among the tracks, the strongest
    first; pairs of other tracks may be among them."""

    def __init__(self, tracks: Iterable[AnyTrack], accepted: Iterable[tuple[int, int]]) -> None:
        self._tracks = {track.track_id: track for track in tracks}
        self._members: dict[int, list[AnyTrack]] = {}
        for track in self._tracks.values():
            self._members.setdefault(track.identity_id, []).append(track)
        self._neighbours: dict[int, set[int]] = {}
        self._links: dict[int, list[tuple[int, int]]] = {}
        for track_a, track_b in accepted:
            if track_a not in self._tracks or track_b not in self._tracks:
                continue
            self._links.setdefault(self.identity_of(track_a), []).append((track_a, track_b))
            self._neighbours.setdefault(track_a, set()).add(track_b)
            self._neighbours.setdefault(track_b, set()).add(track_a)

    def identity_of(self, track_id: int) -> int:
        return self._tracks[track_id].identity_id

    def label_count(self, merge: MergeRow | StoredMerge) -> int:
        """How many labels change when the merge is accepted, or rejected where it holds."""
        track_a, track_b = merge.tracks
        if merge.state == "accepted":
            part = self._side_of(track_a, without=track_b)
            if track_b in part:
                part = self._parted_from(track_a, track_b)
            rest = [track for track in self._members[self.identity_of(track_a)] if track.track_id not in part]
            return _lesser_count([self._tracks[track_id] for track_id in part], rest)
        identity_a, identity_b = self.identity_of(track_a), self.identity_of(track_b)
        if identity_a == identity_b:
            return 0
        return _lesser_count(self._members[identity_a], self._members[identity_b])

    def _side_of(self, start: int, *, without: int) -> set[int]:
        """Tracks that still hang together with ``start`` when its merge with ``without`` is gone."""
        side, waiting = {start}, [start]
        while waiting:
            track = waiting.pop()
            for neighbour in self._neighbours.get(track, ()):
                if neighbour not in side and (track, neighbour) != (start, without):
                    side.add(neighbour)
                    waiting.append(neighbour)
        return side

    def _parted_from(self, track_a: int, track_b: int) -> set[int]:
        """Tracks that are one with ``track_a`` when it may not be one with ``track_b``, though others tie the two."""
        identity = self.identity_of(track_a)
        tracks = {track.track_id: "" for track in self._members[identity]}
        graph = IdentityGraph(tracks, lambda one, other: {one, other} == {track_a, track_b})
        for link in self._links[identity]:
            if graph.conflict(*link) is None:
                graph.join(*link)
        return set(graph.members(track_a))


def _lesser_count(a: Sequence[AnyTrack], b: Sequence[AnyTrack]) -> int:
    """Observations of the group without the best one; 0 where one group is empty."""
    if not a or not b:
        return 0
    lesser = b if best_track([*a, *b]) in a else a
    return sum(track.observation_count for track in lesser)
