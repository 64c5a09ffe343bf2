"""Identities after a change to merges: which tracks are one object now, and what that does to their labels.

Only the tracks that the changed merges can reach are looked at. A person's merges are joined first, the machine's after
them in order of score, all under the cannot-link rule; a merge of the machine that no longer fits becomes a proposal,
and is made again when it fits again. Then every identity takes the label of its best observation (the paper's
Algorithm 3), which is the best of its tracks' best ones.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from app.db.session import Session
from app.identities import repository
from app.merges import repository as merges_repository
from app.merges.repository import Link
from app.tracks import repository as tracks_repository
from app.tracks.models import TrackRow
from labeler.identity.linking import CannotLinkError, IdentityGraph, components


@dataclass(frozen=True)
class Relinked:
    """What changed. ``refused`` are merges of a person that don't fit together with better ones of persons."""

    identity_ids: tuple[int, ...]
    changed_label_count: int
    refused: tuple[int, ...]


class TrackFrames:
    """Whether tracks share a frame, asked of the store only where their times overlap."""

    def __init__(self, session: Session, labelling_id: int, tracks: Iterable[TrackRow]) -> None:
        self._session = session
        self._labelling_id = labelling_id
        self._tracks = {track.track_id: track for track in tracks}
        self._frames: dict[int, set[int]] = {}

    def __call__(self, track_a: int, track_b: int) -> bool:
        return self.first_shared(track_a, track_b) is not None

    def first_shared(self, track_a: int, track_b: int) -> int | None:
        """The first frame that two tracks share, or None."""
        a, b = self._tracks[track_a], self._tracks[track_b]
        if a.last_frame < b.first_frame or b.last_frame < a.first_frame:
            return None
        return min(self._frames_of(track_a) & self._frames_of(track_b), default=None)

    def _frames_of(self, track_id: int) -> set[int]:
        if track_id not in self._frames:
            self._frames[track_id] = tracks_repository.frames_of_track(self._session, self._labelling_id, track_id)
        return self._frames[track_id]


def relink(session: Session, labelling_id: int, changed_tracks: Iterable[int]) -> Relinked:
    """Make identities and labels of all tracks that ``changed_tracks`` can reach fit the merges as they are now."""
    session.flush()
    links = merges_repository.links(session, labelling_id)
    tracks = _reachable(session, labelling_id, set(changed_tracks), links)
    ids = {track.track_id for track in tracks}
    links = [link for link in links if link.track_a in ids]
    graph = IdentityGraph(
        {track.track_id: str(track.camera_id) for track in tracks}, TrackFrames(session, labelling_id, tracks)
    )
    refused = _join(session, graph, links)
    before = {track.identity_id for track in tracks}
    members: dict[int, list[TrackRow]] = {}
    for track in tracks:
        members.setdefault(graph.identity_of(track.track_id), []).append(track)
    changed = sum(_relabel(session, labelling_id, identity, group) for identity, group in members.items())
    rows = [
        identity_values(
            labelling_id,
            identity,
            group,
            propagated_count=repository.propagated_count(session, labelling_id, _ids(group)),
        )
        for identity, group in members.items()
    ]
    repository.replace(session, labelling_id, before | members.keys(), rows)
    return Relinked(tuple(sorted(members)), changed, tuple(refused))


def best_track(tracks: Sequence[TrackRow]) -> TrackRow:
    """The track that holds the best observation: highest score, then earliest frame, then smallest id."""
    return min(tracks, key=lambda track: (-track.best_score, track.best_frame, track.track_id))


def identity_values(
    labelling_id: int, identity_id: int, tracks: Sequence[TrackRow], *, propagated_count: int
) -> dict[str, int | float]:
    """The columns of an identity that has these tracks."""
    best = best_track(tracks)
    return {
        "labelling_id": labelling_id,
        "identity_id": identity_id,
        "class_id": best.class_id,
        "score": best.best_score,
        "donor_track_id": best.track_id,
        "donor_frame_index": best.best_frame,
        "first_frame": min(track.first_frame for track in tracks),
        "last_frame": max(track.last_frame for track in tracks),
        "observation_count": sum(track.observation_count for track in tracks),
        "propagated_count": propagated_count,
    }


def _reachable(session: Session, labelling_id: int, start: set[int], links: Sequence[Link]) -> Sequence[TrackRow]:
    """Tracks that are or could be in one identity with those of ``start``, by way of the links."""
    component_of = components(
        {track for link in links for track in (link.track_a, link.track_b)} | start, _pairs(links)
    )
    wanted = {component_of[track] for track in start}
    ids = {track for track, component in component_of.items() if component in wanted}
    return tracks_repository.tracks_with(session, labelling_id, ids)


def _join(session: Session, graph: IdentityGraph, links: Sequence[Link]) -> list[int]:
    """Join what fits, in the order of the links, and set the machine's merges to what came out."""
    refused: list[int] = []
    made: list[int] = []
    unfit: list[int] = []
    for link in links:
        try:
            graph.join(link.track_a, link.track_b)
        except CannotLinkError:
            if link.decided_by == "person":
                refused.append(link.merge_id)
            elif link.state == "accepted":
                unfit.append(link.merge_id)
        else:
            if link.state != "accepted":
                made.append(link.merge_id)
    merges_repository.set_state(session, made, "accepted")
    merges_repository.set_state(session, unfit, "proposed")
    return refused


def _relabel(session: Session, labelling_id: int, identity_id: int, tracks: Sequence[TrackRow]) -> int:
    """Put tracks into an identity and give them its label; how many labels change."""
    moved = [track.track_id for track in tracks if track.identity_id != identity_id]
    if moved:
        tracks_repository.set_identity(session, labelling_id, moved, identity_id)
    best = best_track(tracks)
    return tracks_repository.relabel(
        session,
        labelling_id,
        _ids(tracks),
        class_id=best.class_id,
        score=best.best_score,
        donor_track_id=best.track_id,
        donor_frame_index=best.best_frame,
    )


def _ids(tracks: Iterable[TrackRow]) -> list[int]:
    return [track.track_id for track in tracks]


def _pairs(links: Iterable[Link]) -> list[tuple[int, int]]:
    return [(link.track_a, link.track_b) for link in links]
