"""Identities after a change to merges: which tracks are one object now, and what that does to their labels.

Only the tracks that the changed merges can reach are looked at. A person's merges are joined first, the machine's after
them in order of score, all under the cannot-link rule; a merge of the machine that no longer fits becomes a proposal,
and is made again when it fits again. Two tracks of which a person rejected the merge are two objects: where others of
the machine's merges tie them, the weakest give way. People's edits bind as their merges do. Then every identity takes
the class that a person gave it, else the labels that the labeler makes of its observations
(:mod:`app.identities.relabelling`).
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

from app.db.session import Session
from app.edits import repository as edits_repository
from app.edits.pairs import Pair, pairs
from app.edits.pieces import Pieces
from app.edits.types import EffectKind
from app.identities import repository
from app.identities.conflicts import MayNotBeOne
from app.identities.relabelling import Relabelled, Relabelling
from app.merges import repository as merges_repository
from app.merges.repository import Link
from app.tracks import label_repository
from app.tracks import repository as tracks_repository
from app.tracks.models import TrackRow
from app.tracks.repository import TrackFacts
from labeler.identity.linking import CannotLinkError, IdentityGraph
from labeler.propagation import Donor
from labeler.propagation.votes import SCORE_DIGITS

T = TypeVar("T", bound=TrackRow | TrackFacts)

HUMAN_SCORE = 1.0
"""The score of a label that is a person's word."""


@dataclass(frozen=True)
class Refused:
    """A merge or a join of a person that doesn't fit together with others of persons.

    ``merge_id`` or ``effect_id`` names it. It would put ``forbidden``, two tracks, into one identity; ``apart`` is the
    decision of a person that forbids it, None where they share a frame.
    """

    track_a: int
    track_b: int
    forbidden: tuple[int, int]
    apart: Pair | None
    merge_id: int | None = None
    effect_id: int | None = None


@dataclass(frozen=True)
class Relinked:
    """What changed: ``identity_ids`` are the identities that were reached, ``gone_identity_ids`` those that are no
    more. ``changed_tracks`` are the tracks that are of another identity now, or have a label that changed. ``joined``
    are the pairs of tracks that people joined, anywhere in the drive."""

    identity_ids: tuple[int, ...]
    changed_label_count: int
    refused: tuple[Refused, ...]
    gone_identity_ids: tuple[int, ...] = ()
    changed_tracks: frozenset[int] = frozenset()
    joined: tuple[tuple[int, int], ...] = ()


@dataclass(frozen=True)
class Said:
    """What people say of an identity. ``class_id`` and ``mark`` are None where they say nothing."""

    class_id: int | None = None
    mark: str | None = None
    comment_count: int = 0


def relink(
    session: Session, labelling_id: int, changed_tracks: Iterable[int], *, gone_identities: Iterable[int] = ()
) -> Relinked:
    """Make identities and labels of all tracks that ``changed_tracks`` can reach fit the merges as they are now.

    ``gone_identities`` are those that tracks which are there no longer were in."""
    session.flush()
    pieces = edits_repository.pieces(session, labelling_id)
    of_pairs = _of_tracks_that_are(session, labelling_id, pairs(session, labelling_id, pieces))
    same = [pair for pair in of_pairs if pair.kind is EffectKind.SAME]
    ids, merges = _reachable(session, labelling_id, set(changed_tracks), same)
    links = _in_order(merges, [pair for pair in same if pair.track_a in ids])
    tracks = tracks_repository.tracks_with(session, labelling_id, ids)
    forbids = MayNotBeOne(session, labelling_id, tracks, of_pairs)
    graph = IdentityGraph(dict.fromkeys(ids, ""), forbids)  # one camera for all: the rule looks at cameras itself
    refused = _join(session, graph, links, forbids)
    identity_before = {track.track_id: track.identity_id for track in tracks}
    before = {*identity_before.values(), *gone_identities}
    members: dict[int, list[TrackRow]] = {}
    for track in tracks:
        members.setdefault(graph.identity_of(track.track_id), []).append(track)
    said = _said(session, labelling_id, tracks, pieces, graph.identity_of)
    relabelling = Relabelling(session, labelling_id)
    relabelled = {
        identity: _relabel(session, labelling_id, identity, group, said.get(identity, Said()), relabelling)
        for identity, group in members.items()
    }
    rows = [
        identity_values(
            labelling_id,
            identity,
            group,
            donor=relabelled[identity].donor,
            propagated_count=repository.propagated_count(session, labelling_id, _ids(group)),
            said=said.get(identity, Said()),
        )
        for identity, group in members.items()
    ]
    repository.replace(session, labelling_id, before | members.keys(), rows)
    moved = {
        track for identity, group in members.items() for track in _ids(group) if identity_before[track] != identity
    }
    return Relinked(
        tuple(sorted(members)),
        sum(one.changed_count for one in relabelled.values()),
        tuple(refused),
        gone_identity_ids=tuple(sorted(before - members.keys())),
        changed_tracks=frozenset(moved.union(*(one.changed_tracks for one in relabelled.values()))),
        joined=tuple((pair.track_a, pair.track_b) for pair in same),
    )


def best_track(tracks: Sequence[T]) -> T:
    """The track that holds the best observation: highest score, then earliest frame, then smallest id.

    Tracks without any score come last."""

    def rank(track: TrackRow | TrackFacts) -> tuple[bool, float, int, int]:
        return (track.best_score is None, -(track.best_score or 0.0), track.best_frame, track.track_id)

    return min(tracks, key=rank)


def identity_values(
    labelling_id: int,
    identity_id: int,
    tracks: Sequence[TrackRow],
    *,
    donor: Donor | None,
    propagated_count: int,
    said: Said = Said(),
) -> dict[str, int | float | str | None]:
    """The columns of an identity that has these tracks, and that donor; None where no observation has a score."""
    best = best_track(tracks)
    class_id, score = (best.class_id, None) if donor is None else (donor.class_id, round(donor.score, SCORE_DIGITS))
    return {
        "labelling_id": labelling_id,
        "identity_id": identity_id,
        "class_id": class_id if said.class_id is None else said.class_id,
        "score": score if said.class_id is None else HUMAN_SCORE,
        "donor_track_id": best.track_id if donor is None else donor.track_id,
        "donor_frame_index": best.best_frame if donor is None else donor.frame_index,
        "first_frame": min(track.first_frame for track in tracks),
        "last_frame": max(track.last_frame for track in tracks),
        "observation_count": sum(track.observation_count for track in tracks),
        "propagated_count": propagated_count,
        "class_by_person": said.class_id is not None,
        "mark": said.mark,
        "comment_count": said.comment_count,
    }


def _of_tracks_that_are(session: Session, labelling_id: int, said: Sequence[Pair]) -> list[Pair]:
    """The pairs of which no track was deleted."""
    ids = {track for pair in said for track in (pair.track_a, pair.track_b)}
    there = {track.track_id for track in tracks_repository.tracks_with(session, labelling_id, ids)}
    return [pair for pair in said if pair.track_a in there and pair.track_b in there]


def _in_order(merges: Sequence[Link], joined: Iterable[Pair]) -> list[Link | Pair]:
    """What makes tracks one object, the strongest first: a person's merges by score, a person's joins in the order in
    which they were said, the machine's merges by score."""
    by_score = sorted(merges, key=lambda link: (-link.score, link.merge_id))
    by_person = [link for link in by_score if link.decided_by == "person"]
    by_machine = [link for link in by_score if link.decided_by != "person"]
    return [*by_person, *joined, *by_machine]


def _said(
    session: Session,
    labelling_id: int,
    tracks: Sequence[TrackRow],
    pieces: Pieces,
    identity_of: Callable[[int], int],
) -> dict[int, Said]:
    """What people say of each identity that they say anything of: their last words, and how many comments."""
    there = {track.track_id for track in tracks}
    effects = edits_repository.sayings(session, labelling_id, {track.tracked_id for track in tracks})
    if not effects:
        return {}
    names = tracks_repository.find_labelling(session, labelling_id).class_names
    said: dict[int, Said] = {}
    for effect in effects:
        track_id = pieces.track_at(effect.place)
        if track_id not in there:
            continue
        identity = identity_of(track_id)
        known = said.get(identity, Said())
        match effect.kind:
            case EffectKind.CLASS:
                known = replace(known, class_id=names.index(effect.value["class_name"]))
            case EffectKind.MARK:
                mark = effect.value["mark"]
                known = replace(known, mark=None if mark == "open" else mark)
            case _:
                known = replace(known, comment_count=known.comment_count + 1)
        said[identity] = known
    return said


def _reachable(
    session: Session, labelling_id: int, start: set[int], joined: Sequence[Pair]
) -> tuple[set[int], list[Link]]:
    """Tracks that are or could be in one identity with those of ``start``, and the merges that say so.

    Asks the store for the merges of what was reached last, so that a decision costs what it reaches, not what the drive
    holds."""
    neighbours: dict[int, set[int]] = {}
    for pair in joined:
        neighbours.setdefault(pair.track_a, set()).add(pair.track_b)
        neighbours.setdefault(pair.track_b, set()).add(pair.track_a)
    reached, waiting = set(start), set(start)
    merges: dict[int, Link] = {}
    while waiting:
        found = merges_repository.links_of_tracks(session, labelling_id, waiting)
        merges |= {link.merge_id: link for link in found}
        beside = {track for link in found for track in (link.track_a, link.track_b)}
        beside.update(*(neighbours.get(track, ()) for track in waiting))
        waiting = beside - reached
        reached |= waiting
    return reached, list(merges.values())


def _join(session: Session, graph: IdentityGraph, links: Sequence[Link | Pair], forbids: MayNotBeOne) -> list[Refused]:
    """Join what fits, in the order of the links, and set the machine's merges to what came out."""
    refused: list[Refused] = []
    made: list[int] = []
    unfit: list[int] = []
    for link in links:
        try:
            graph.join(link.track_a, link.track_b)
        except CannotLinkError as error:
            if isinstance(link, Link) and link.decided_by != "person":
                if link.state == "accepted":
                    unfit.append(link.merge_id)
                continue
            forbidden = (error.track_a, error.track_b)
            refused.append(
                Refused(
                    link.track_a,
                    link.track_b,
                    forbidden,
                    forbids.apart(*forbidden),
                    merge_id=link.merge_id if isinstance(link, Link) else None,
                    effect_id=link.effect_id if isinstance(link, Pair) else None,
                )
            )
        else:
            if isinstance(link, Link) and link.state != "accepted":
                made.append(link.merge_id)
    merges_repository.set_state(session, made, "accepted")
    merges_repository.set_state(session, unfit, "proposed")
    return refused


def _relabel(
    session: Session,
    labelling_id: int,
    identity_id: int,
    tracks: Sequence[TrackRow],
    said: Said,
    relabelling: Relabelling,
) -> Relabelled:
    """Put tracks into an identity and give them its labels."""
    moved = [track.track_id for track in tracks if track.identity_id != identity_id]
    if moved:
        tracks_repository.set_identity(session, labelling_id, moved, identity_id)
    ids = _ids(tracks)
    if said.class_id is not None:
        changed = label_repository.label_by_person(
            session, labelling_id, ids, class_id=said.class_id, score=HUMAN_SCORE, drawn_only=False
        )
        return Relabelled(relabelling.donor(ids), changed, frozenset(ids if changed else ()))
    found = relabelling.relabel(ids)
    class_id = best_track(tracks).class_id if found.donor is None else found.donor.class_id
    drawn = label_repository.label_by_person(
        session, labelling_id, ids, class_id=class_id, score=HUMAN_SCORE, drawn_only=True
    )
    return Relabelled(found.donor, found.changed_count + drawn, found.changed_tracks.union(ids if drawn else ()))


def _ids(tracks: Iterable[TrackRow]) -> list[int]:
    return [track.track_id for track in tracks]
