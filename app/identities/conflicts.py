"""Why tracks can't be one object: they share a frame of one camera, or a person said that they are two."""

from collections.abc import Iterable, Sequence

from app.db.session import Session
from app.edits import repository as edits_repository
from app.edits.pairs import Pair, pairs
from app.edits.types import Effect, EffectKind
from app.errors import CannotLink
from app.tracks import repository as tracks_repository
from app.tracks.models import TrackRow
from labeler.identity.linking import IdentityGraph


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


class MayNotBeOne:
    """Whether two tracks can't be one object: they share a frame of a camera, or a person said that they are two."""

    def __init__(self, session: Session, labelling_id: int, tracks: Sequence[TrackRow], said: Iterable[Pair]) -> None:
        self.frames = TrackFrames(session, labelling_id, tracks)
        self._cameras = {track.track_id: track.camera_id for track in tracks}
        self._apart = {frozenset((pair.track_a, pair.track_b)): pair for pair in said if pair.kind is EffectKind.APART}

    def __call__(self, track_a: int, track_b: int) -> bool:
        if self.apart(track_a, track_b) is not None:
            return True
        return self._cameras[track_a] == self._cameras[track_b] and self.frames(track_a, track_b)

    def apart(self, track_a: int, track_b: int) -> Pair | None:
        """What a person said."""
        return self._apart.get(frozenset((track_a, track_b)))


def require_one_object(
    session: Session, labelling_id: int, track_ids: Sequence[int], *, lifted: Sequence[Effect] = ()
) -> None:
    """CannotLink, with the reason, where the identities of some tracks can't be one object together.

    ``lifted`` takes back what people said of pairs of them."""
    first, *others = tracks_repository.tracks_with(session, labelling_id, track_ids)
    identities = {track.identity_id for track in (first, *others)}
    tracks = tracks_repository.tracks_of_identities(session, labelling_id, identities)
    pieces = edits_repository.pieces(session, labelling_id)
    open_pairs = {
        frozenset((pieces.track_at(effect.place), pieces.track_at(effect.other))) for effect in lifted if effect.other
    }
    said = [
        pair
        for pair in pairs(session, labelling_id, pieces)
        if frozenset((pair.track_a, pair.track_b)) not in open_pairs
    ]
    forbids = MayNotBeOne(session, labelling_id, tracks, said)
    graph = IdentityGraph(dict.fromkeys((track.track_id for track in tracks), ""), lambda a, b: False)
    for identity in identities:
        members = [track.track_id for track in tracks if track.identity_id == identity]
        for other in members[1:]:
            graph.join(members[0], other)
    for other in others:
        conflict = _conflict(graph, forbids, first.track_id, other.track_id)
        if conflict is not None:
            raise CannotLink(why_not(session, labelling_id, (first.track_id, other.track_id), conflict, forbids))
        graph.join(first.track_id, other.track_id)


def _conflict(graph: IdentityGraph, forbids: MayNotBeOne, track_a: int, track_b: int) -> tuple[int, int] | None:
    if graph.identity_of(track_a) == graph.identity_of(track_b):
        return None
    return next(((a, b) for a in graph.members(track_a) for b in graph.members(track_b) if forbids(a, b)), None)


def why_not(
    session: Session, labelling_id: int, wanted: tuple[int, int], forbidden: tuple[int, int], forbids: MayNotBeOne
) -> str:
    """A sentence for the user: which two of the tracks forbid it, and what to do."""
    a, b = forbidden
    asked = f"Tracks {wanted[0]} and {wanted[1]} can't be one object: "
    said = forbids.apart(a, b)
    if said is not None:
        return (
            f"{asked}a person said that tracks {a} and {b} are two objects. Undo that decision first: it is number "
            f"{said.review_id} in the log."
        )
    track = next(track for track in tracks_repository.tracks_with(session, labelling_id, (a,)))
    drive = tracks_repository.drive_of_labelling(session, labelling_id)
    camera = tracks_repository.camera_names(session, drive.id)[track.camera_id]
    return (
        f"{asked}tracks {a} and {b} would be one with them, and both are in camera {camera} in frame "
        f"{forbids.frames.first_shared(a, b)}. Reject the merge that leads to the wrong one, or split the track, first."
    )
