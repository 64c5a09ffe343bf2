"""Facts about identities that follow from their boxes: distances, physics checks that fail, and purity.

They are worked out when they are asked for. What an identity is made of seldom changes, so what was worked out is kept,
and after a decision only the identities that it changed are looked at again.
"""

import threading
from collections import OrderedDict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from app.db.session import Session
from app.motion import repository
from app.motion.checks import Failure, distances_m, failures
from app.motion.paths import paths_of_tracks
from app.tracks import repository as tracks_repository
from app.tracks.models import LabellingRow
from app.tracks.repository import TrackFacts

KEPT_LABELLINGS = 4
TRACKS_AT_ONCE = 2_000
PURITY_DIGITS = 3

Parts = tuple[tuple[int, int, int, int], ...]
"""What an identity is made of: id, first and last frame and number of boxes of each track; the class beside it."""


@dataclass(frozen=True)
class Facts:
    """``nearest_m`` and ``farthest_m`` are distances from the car, None without 3D boxes.

    ``purity`` is the share of boxes that show the object that their track is of, as far as the tracker can judge: the
    mean trust in the boxes; None where none was judged."""

    nearest_m: float | None
    farthest_m: float | None
    failed: tuple[Failure, ...]
    purity: float | None


@dataclass
class _Known:
    """What was worked out for a labelling, by identity."""

    facts: dict[int, tuple[int, Parts, Facts]] = field(default_factory=dict[int, tuple[int, Parts, Facts]])


class FactsCache:
    """Keeps facts of the labellings that were looked at last. Thread-safe."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._labellings: OrderedDict[int, _Known] = OrderedDict()

    def facts_of(self, session: Session, labelling: LabellingRow) -> dict[int, Facts]:
        """The facts of every identity of a labelling, as it is now."""
        with self._lock:
            known = self._labellings.setdefault(labelling.id, _Known())
            self._labellings.move_to_end(labelling.id)
            while len(self._labellings) > KEPT_LABELLINGS:
                self._labellings.popitem(last=False)
            before = dict(known.facts)
        classes = dict(repository.classes_of_identities(session, labelling.id))
        members: dict[int, list[TrackFacts]] = {identity_id: [] for identity_id in classes}
        for track in tracks_repository.track_facts(session, labelling.id):
            members[track.identity_id].append(track)
        now: dict[int, tuple[int, Parts, Facts]] = {}
        changed: dict[int, list[TrackFacts]] = {}
        for identity_id, tracks in members.items():
            parts, old = _parts(tracks), before.get(identity_id)
            if old is not None and old[:2] == (classes[identity_id], parts):
                now[identity_id] = old
            else:
                changed[identity_id] = tracks
        for identity_id, facts in _work_out(session, labelling, changed, classes):
            now[identity_id] = (classes[identity_id], _parts(members[identity_id]), facts)
        with self._lock:
            known.facts = now
        return {identity_id: entry[2] for identity_id, entry in now.items()}


def _parts(tracks: Iterable[TrackFacts]) -> Parts:
    return tuple((track.track_id, track.first_frame, track.last_frame, track.observation_count) for track in tracks)


def _work_out(
    session: Session, labelling: LabellingRow, members: Mapping[int, list[TrackFacts]], classes: Mapping[int, int]
) -> Iterable[tuple[int, Facts]]:
    """A few identities at a time, so that memory does not grow with the drive."""
    waiting: list[int] = []
    count = 0
    for identity_id, tracks in members.items():
        waiting.append(identity_id)
        count += len(tracks)
        if count >= TRACKS_AT_ONCE:
            yield from _facts(session, labelling, {one: members[one] for one in waiting}, classes)
            waiting, count = [], 0
    yield from _facts(session, labelling, {one: members[one] for one in waiting}, classes)


def _facts(
    session: Session, labelling: LabellingRow, members: Mapping[int, list[TrackFacts]], classes: Mapping[int, int]
) -> Iterable[tuple[int, Facts]]:
    track_ids = [track.track_id for tracks in members.values() for track in tracks]
    ways = paths_of_tracks(session, labelling.drive_id, labelling.id, track_ids)
    trust = repository.trust_of_tracks(session, labelling.id, track_ids)
    for identity_id, tracks in members.items():
        paths = [ways[track.track_id] for track in tracks if track.track_id in ways]
        name = labelling.class_names[classes[identity_id]]
        failed = failures(paths, name, _shared_frame(session, labelling.id, tracks))
        judged = [trust[track.track_id] for track in tracks if track.track_id in trust]
        yield identity_id, Facts(*distances_m(paths), tuple(failed), _purity(judged))


def _purity(judged: Sequence[tuple[float, int]]) -> float | None:
    boxes = sum(count for _, count in judged)
    return round(sum(total for total, _ in judged) / boxes, PURITY_DIGITS) if boxes else None


def _shared_frame(session: Session, labelling_id: int, tracks: list[TrackFacts]) -> int | None:
    """The first frame in which two tracks of one camera are; asked of the store only where their times overlap."""
    by_camera: dict[int, list[TrackFacts]] = {}
    for track in tracks:
        by_camera.setdefault(track.camera_id, []).append(track)
    for group in by_camera.values():
        group.sort(key=lambda track: track.first_frame)
        for one, other in pairwise(group):
            if other.first_frame <= one.last_frame:
                frames = [tracks_repository.frames_of_track(session, labelling_id, t.track_id) for t in (one, other)]
                shared = frames[0] & frames[1]
                if shared:
                    return min(shared)
    return None
