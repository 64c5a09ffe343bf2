"""Carrying edits over to another labelling of the same drive."""

from dataclasses import dataclass

from app.db.session import Session
from app.edits import repository
from app.edits import track_repository as tracks
from app.edits.anchors import EffectFinder
from app.edits.applying import reshape_tracks
from app.edits.types import SHAPING
from app.reviews import repository as reviews_repository
from app.tracks.models import LabellingRow


@dataclass(frozen=True)
class CarriedEdits:
    """``track_ids`` are the tracks that edits are about; ``held``, ``lost`` count edits. Lost ones may hold in part."""

    track_ids: frozenset[int]
    held: int
    lost: int


def carry_edits(session: Session, labelling: LabellingRow) -> CarriedEdits:
    """Let the edits of people shape the tracks of a labelling; its identities are to be linked anew after that.

    What an edit says of a place that is not found is left out; it is kept, and may fit the labelling after.
    """
    finder = EffectFinder(session, labelling)
    named: set[int] = set()
    shaped: set[int] = set()
    held = lost = 0
    for review in reviews_repository.edits_that_hold(session, labelling.drive_id):
        payloads = review.payload["effects"]
        effects = [effect for payload in payloads if (effect := finder.find(payload, review_id=review.id)) is not None]
        repository.insert(session, labelling.id, review.id, effects, active=True)
        for effect in effects:
            named.update(place.tracked_id for place in (effect.place, effect.other) if place is not None)
            if effect.kind in SHAPING:
                shaped.add(effect.place.tracked_id)
        held += len(effects) == len(payloads)
        lost += len(effects) != len(payloads)
    if shaped:
        reshape_tracks(session, labelling, sorted(shaped))
    found = tracks.pieces_of(session, labelling.id, named)
    return CarriedEdits(frozenset(track.track_id for track in found), held, lost)
