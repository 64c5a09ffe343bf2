"""What people decided about pairs of tracks, as constraints on the next run of the pipeline."""

from collections.abc import Iterator, Mapping
from typing import Any

from app.db.session import Session
from app.edits.types import EffectKind
from app.reviews import repository
from app.reviews.schemas import ReviewAction, TrackAnchor
from labeler.identity import Decisions
from labeler.identity import TrackAnchor as RunAnchor

Pair = tuple[RunAnchor, RunAnchor]
Said = tuple[int, Pair, bool | None]

_OF_REVIEW = {ReviewAction.ACCEPT: True, ReviewAction.REJECT: False}
_OF_EDIT = {EffectKind.SAME: True, EffectKind.APART: False, EffectKind.OPEN: None}


def constraints_about(session: Session, drive_id: int) -> Decisions:
    """Which pairs of tracks of a drive are one object, and which are two, by the latest that people said of each."""
    said = sorted([*_of_reviews(session, drive_id), *_of_edits(session, drive_id)], key=_age)
    latest = {pair: is_one for _, pair, is_one in said}
    return Decisions(
        same=tuple(pair for pair, is_one in latest.items() if is_one is True),
        different=tuple(pair for pair, is_one in latest.items() if is_one is False),
    )


def _of_reviews(session: Session, drive_id: int) -> Iterator[Said]:
    for review in repository.latest_of_subjects(session, drive_id):
        pair = _anchor(review.anchor_a), _anchor(review.anchor_b)
        yield review.id, pair, _OF_REVIEW.get(ReviewAction(review.action))


def _of_edits(session: Session, drive_id: int) -> Iterator[Said]:
    for review in repository.edits_that_hold(session, drive_id):
        for effect in review.payload["effects"]:
            kind, other = EffectKind(effect["kind"]), effect["other"]
            if kind in _OF_EDIT and "anchor" in effect["place"] and "anchor" in other:  # not one that a person drew
                yield review.id, (_anchor(effect["place"]["anchor"]), _anchor(other["anchor"])), _OF_EDIT[kind]


def _anchor(stored: Mapping[str, Any]) -> RunAnchor:
    anchor = TrackAnchor.model_validate(stored)
    return RunAnchor(anchor.camera, (anchor.frame_index,), (anchor.box,))


def _age(said: Said) -> int:
    return said[0]
