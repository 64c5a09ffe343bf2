"""What people say of pairs of tracks: that the two are one object, or that they are two.

They say it by edits, and by rejecting a merge.
"""

from typing import NamedTuple

from app.db.session import Session
from app.edits import repository
from app.edits.pieces import Pieces
from app.edits.repository import Word
from app.edits.types import EffectKind, Place
from app.merges import repository as merges_repository


class Pair(NamedTuple):
    """What people say of two tracks: ``kind`` is SAME or APART. ``effect_id`` is None where a merge was rejected."""

    track_a: int
    track_b: int
    kind: EffectKind
    effect_id: int | None
    review_id: int
    place: Place
    other: Place


def pairs(session: Session, labelling_id: int, pieces: Pieces) -> list[Pair]:
    """What people say of pairs of tracks, in the order in which it was said; the last word on each pair.

    Two places of one track are no pair."""
    words = [*repository.pairing(session, labelling_id), *_rejections(session, labelling_id)]
    found: dict[frozenset[int], Pair] = {}
    for word in sorted(words, key=lambda word: (word.review_id, word.effect_id or 0)):
        track_a, track_b = pieces.track_at(word.place), pieces.track_at(word.other)
        key = frozenset((track_a, track_b))
        found.pop(key, None)  # so that the order is that of the last words
        if track_a != track_b and word.kind is not EffectKind.OPEN:
            found[key] = Pair(track_a, track_b, word.kind, word.effect_id, word.review_id, word.place, word.other)
    return list(found.values())


def _rejections(session: Session, labelling_id: int) -> list[Word]:
    return [
        Word(
            EffectKind.APART,
            Place(row.tracked_a, row.frame_a),
            Place(row.tracked_b, row.frame_b),
            effect_id=None,
            review_id=row.review_id,
        )
        for row in merges_repository.rejections(session, labelling_id)
    ]
