"""Identities and labels after any decisions: they must be what the labeler makes of the same identities."""

import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sqlalchemy import select

from app.db.engine import migrate, open_engine
from app.db.session import Session, Store
from app.drives.schemas import DriveRegistration
from app.drives.service import add_local_drive
from app.errors import CannotLink, Conflict
from app.identities.models import IdentityRow
from app.merges import repository as merges
from app.merges import service
from app.tracks import repository
from app.tracks.importing import import_labelled_drive
from app.tracks.models import LabelRow
from labeler.identity.linking import components
from labeler.propagation import Donor, PropagationConfig, Withheld
from tests.app.conftest import Page
from tests.app.made_labels import MERGES, TRACKS, make_labelled_drive

PAIRS = [(a, b) for a, b, _, _ in MERGES]
DOUBTED = tuple(replace(track, doubtful=(1,)) if track.track_id in (1, 2) else track for track in TRACKS)
"""Two boxes of the first identity keep their own labels."""

VERBS = {
    "accept": service.accept_merge,
    "reject": service.reject_merge,
    "unsure": service.leave_merge_open,
    "undo": service.undo_merge,
}
RULES = st.sampled_from(
    [PropagationConfig(), PropagationConfig(rule="top-k", top_k=3), PropagationConfig(window_s=0.2)]
)
DECISIONS = st.lists(st.tuples(st.sampled_from(sorted(VERBS)), st.sampled_from(PAIRS)), max_size=8)


@contextmanager
def _labelled_store(drive: Path, propagation: PropagationConfig | None = None) -> Iterator[tuple[Store, int]]:
    """A store with the labels of tests/app/made_labels.py, and the labelling's id."""
    with tempfile.TemporaryDirectory() as folder:
        engine = open_engine(f"sqlite:///{folder}/store.db")
        migrate(engine)
        store = Store(engine)
        drive_id = add_local_drive(store, DriveRegistration(path=str(drive))).id
        import_labelled_drive(store, drive_id, make_labelled_drive(DOUBTED, propagation=propagation), model_name="made")
        with store.read() as session:
            labelling = repository.current_labelling(session, drive_id)
        assert labelling is not None
        yield store, labelling.id
        engine.dispose()


def _decide(store: Store, labelling_id: int, verb: str, pair: tuple[int, int]) -> None:
    """Decide; what the rules forbid changes nothing."""
    try:
        with store.write() as session:
            merge = merges.find_pair(session, labelling_id, *pair)
            assert merge is not None
            VERBS[verb](session, merge.id, reviewer="test")
    except (CannotLink, Conflict):
        pass


def _accepted(session: Session, labelling_id: int) -> list[tuple[int, int]]:
    return merges.accepted_pairs(session, labelling_id)


@given(decisions=DECISIONS, propagation=RULES)
@settings(max_examples=15, deadline=None)
def test_any_decisions(
    decisions: list[tuple[str, tuple[int, int]]], propagation: PropagationConfig, three_camera_drive: Path
) -> None:
    with _labelled_store(three_camera_drive, propagation) as (store, labelling_id):
        for verb, pair in decisions:
            _decide(store, labelling_id, verb, pair)
        with store.read() as session:
            accepted = _accepted(session, labelling_id)
            tracks = repository.tracks_of(session, labelling_id)
            labels = session.scalars(select(LabelRow)).all()
            identities = session.scalars(select(IdentityRow)).all()
            rows = merges.list_by_score(session, labelling_id)

    # identities are the components of the accepted merges
    identity_of = {track.track_id: track.identity_id for track in tracks}
    assert identity_of == components(identity_of, accepted)
    assert sorted(row.identity_id for row in identities) == sorted(set(identity_of.values()))

    # two tracks of one camera that share a frame are never one object
    for a, b in combinations(TRACKS, 2):
        if a.camera == b.camera and a.scores.keys() & b.scores.keys():
            assert identity_of[a.track_id] != identity_of[b.track_id]

    # nor are two of which a person said so
    for row in rows:
        if row.decided_by == "person" and row.state == "rejected":
            assert identity_of[row.tracks[0]] != identity_of[row.tracks[1]]

    # labels are those that the labeler gives to these identities
    expected, donors = _labels_of(identity_of, propagation)
    assert {
        (row.track_id, row.frame_index): (
            row.class_id,
            row.score,
            row.source,
            row.donor_track_id,
            row.donor_frame_index,
            row.withheld,
            row.probability,
        )
        for row in labels
    } == expected
    for row in identities:
        of_identity = [label for (track, _), label in expected.items() if identity_of[track] == row.identity_id]
        assert row.observation_count == len(of_identity)
        assert row.propagated_count == sum(label[2] == "propagated" for label in of_identity)
        donor = donors[row.identity_id]
        assert (row.class_id, row.score) == (donor.class_id, pytest.approx(donor.score))
        assert (row.donor_track_id, row.donor_frame_index) == (donor.track_id, donor.frame_index)


def _labels_of(
    identity_of: dict[int, int], propagation: PropagationConfig
) -> tuple[dict[tuple[int, int], tuple[Any, ...]], Mapping[int, Donor]]:
    """What the labeler's own propagation makes of identities: labels by track and frame, and donors."""
    made = make_labelled_drive(DOUBTED, identity_of=identity_of, propagation=propagation)
    found: dict[tuple[int, int], tuple[Any, ...]] = {}
    for frame in made.frames():
        for view in frame.views.values():
            labels = view.labels
            for row in range(len(labels)):
                found[int(labels.track_id[row]), frame.frame_index] = (
                    int(labels.class_id[row]),
                    round(float(labels.score[row]), 6),
                    "propagated" if labels.propagated[row] else "auto",
                    int(labels.donor_track_id[row]),
                    int(labels.donor_frame_index[row]),
                    "doubtful_box" if labels.withheld[row] == Withheld.DOUBTFUL_BOX else None,
                    round(float(labels.probability[row]), 4),
                )
    return found, made.donors


@given(decisions=DECISIONS)
@settings(max_examples=10, deadline=None)
def test_what_holds_depends_on_the_last_words_only(
    decisions: list[tuple[str, tuple[int, int]]], three_camera_drive: Path
) -> None:
    with _labelled_store(three_camera_drive) as (store, labelling_id):
        for verb, pair in decisions:
            _decide(store, labelling_id, verb, pair)
        with store.read() as session:
            before = _accepted(session, labelling_id)
            rows = merges.list_by_score(session, labelling_id)
            said = {row.tracks: row.state.removesuffix("ed") for row in rows if row.decided_by == "person"}
    with _labelled_store(three_camera_drive) as (store, labelling_id):
        for row in rows:  # what the machine merged stands in the way of what a person accepted later
            _decide(store, labelling_id, "unsure", row.tracks)
        for pair, verb in said.items():
            _decide(store, labelling_id, verb, pair)
        for row in rows:
            if row.tracks not in said:
                _decide(store, labelling_id, "undo", row.tracks)
        with store.read() as session:
            assert _accepted(session, labelling_id) == before


def test_an_identity_in_full(page: Page) -> None:
    first = page.get("identities")[0]
    assert first.pop("donor") | {"observation_id": 0} == {
        "observation_id": 0,
        "track_id": 1,
        "camera": "front",
        "frame_index": 2,
        "score": 0.9,
    }
    assert first == {
        "id": 1,
        "class_name": "car",
        "score": 0.9,
        "camera_names": ["front", "left"],
        "track_ids": [1, 2],
        "first_frame": 0,
        "last_frame": 5,
        "observation_count": 10,
        "propagated_count": 9,
        "class_by_person": False,
        "mark": None,
        "comment_count": 0,
    }
