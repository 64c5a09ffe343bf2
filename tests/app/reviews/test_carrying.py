"""A person's decisions after the drive was labelled again."""

from dataclasses import replace

import pytest

from app.db.session import Store
from app.tracks.importing import import_labelled_drive
from labeler.identity.types import MergeState
from tests.app.conftest import Page
from tests.app.made_labels import MERGES, TRACKS, MadeTrack, make_labelled_drive

NEW_ID = {1: 11, 2: 8, 3: 7, 4: 15, 5: 3}


def renumbered(
    *,
    shift_px: float = 1.0,
    without: int | None = None,
    merges: tuple[tuple[int, int, float, MergeState], ...] = MERGES,
) -> tuple[tuple[MadeTrack, ...], tuple[tuple[int, int, float, MergeState], ...]]:
    """The same objects under other numbers, their boxes (8 px wide) moved a little."""
    tracks = tuple(
        replace(track, track_id=NEW_ID[track.track_id], x_px=track.x_px + shift_px)
        for track in TRACKS
        if track.track_id != without
    )
    pairs = tuple(
        (min(NEW_ID[a], NEW_ID[b]), max(NEW_ID[a], NEW_ID[b]), score, state)
        for a, b, score, state in merges
        if without not in (a, b)
    )
    return tracks, pairs


def _label_again(
    store: Store,
    page: Page,
    tracks: tuple[MadeTrack, ...],
    merges: tuple[tuple[int, int, float, MergeState], ...],
    key: str = "second",
) -> list[str]:
    """The drive's new warnings."""
    import_labelled_drive(store, page.drive_id, make_labelled_drive(tracks, merges, key=key), model_name="made")
    warnings = page.client.get(f"/api/drives/{page.drive_id}").json()["warnings"]
    return [warning for warning in warnings if "decision" in warning]


def test_decisions_hold_for_the_same_objects_under_other_numbers(store: Store, page: Page) -> None:
    page.decide("accept", 3, 4)
    page.decide("reject", 1, 2)
    assert _label_again(store, page, *renumbered()) == []
    accepted, rejected = page.merge(7, 15), page.merge(8, 11)
    assert (accepted["state"], accepted["decided_by"]) == ("accepted", "person")
    assert (rejected["state"], rejected["decided_by"]) == ("rejected", "person")
    assert [identity["track_ids"] for identity in page.get("identities")] == [[3], [7, 15], [8], [11]]
    labels = page.labels()
    assert labels[15, 1] == ("car", 0.7, "propagated", 7)
    assert labels[8, 3] == ("truck", 0.6, "auto", 8)


def test_decisions_can_be_undone_after_labelling_again(store: Store, page: Page) -> None:
    page.decide("accept", 3, 4)
    _label_again(store, page, *renumbered())
    undone = page.decide("undo", 7, 15)
    assert (undone["merge"]["state"], undone["merge"]["decided_by"]) == ("proposed", "machine")
    _label_again(store, page, TRACKS, MERGES, key="third")
    assert (page.merge(3, 4)["state"], page.merge(3, 4)["decided_by"]) == ("proposed", "machine")


@pytest.mark.parametrize(
    ("shift_px", "holds"),
    [
        (2.0, True),  # IoU 6 / 10
        (3.0, False),  # IoU 5 / 11
    ],
)
def test_half_an_overlap_makes_the_same_object(store: Store, page: Page, shift_px: float, holds: bool) -> None:
    page.decide("accept", 3, 4)
    warnings = _label_again(store, page, *renumbered(shift_px=shift_px))
    assert (page.merge(7, 15)["state"] == "accepted") is holds
    assert (warnings == []) is holds


def test_a_decision_that_finds_no_track_waits_for_the_next_labelling(store: Store, page: Page) -> None:
    page.decide("accept", 3, 4)
    (warning,) = _label_again(store, page, *renumbered(without=4))
    assert warning.startswith("1 earlier decision")
    assert _label_again(store, page, TRACKS, MERGES, key="third") == []
    assert (page.merge(3, 4)["state"], page.merge(3, 4)["decided_by"]) == ("accepted", "person")


def test_a_merge_that_the_machine_no_longer_proposes_is_kept_with_its_evidence(store: Store, page: Page) -> None:
    page.decide("accept", 3, 4)
    tracks, _ = renumbered()
    assert _label_again(store, page, tracks, ()) == []
    merge = page.merge(7, 15)
    assert (merge["state"], merge["decided_by"], merge["score"]) == ("accepted", "person", 0.4)
    assert merge["best_frames"][0]["distance_m"] == 0.4
    assert page.labels()[15, 0] == ("car", 0.7, "propagated", 7)


def test_a_decision_that_has_become_impossible_is_counted_and_not_applied(store: Store, page: Page) -> None:
    # here 2 and 3 share no frame, so both can be one with 4
    apart = (replace(TRACKS[1], scores={1: 0.6}), replace(TRACKS[2], scores={4: 0.7}), TRACKS[3])
    pairs = ((3, 4, 0.4, MergeState.PROPOSED), (2, 4, 0.3, MergeState.PROPOSED))
    _label_again(store, page, apart, pairs, key="apart")
    page.decide("accept", 2, 4)
    page.decide("accept", 3, 4)
    # now they do share frames: the one with more evidence holds
    (warning,) = _label_again(store, page, TRACKS[1:4], pairs)
    assert warning.startswith("1 earlier decision")
    assert (page.merge(3, 4)["state"], page.merge(3, 4)["decided_by"]) == ("accepted", "person")
    assert (page.merge(2, 4)["state"], page.merge(2, 4)["decided_by"]) == ("proposed", "machine")
    assert [identity["track_ids"] for identity in page.get("identities")] == [[2], [3, 4]]


def test_the_machine_may_have_fewer_tracks_this_time(store: Store, page: Page) -> None:
    page.decide("accept", 2, 4)
    one = MadeTrack(2, "left", 1, dict.fromkeys(range(6), 0.5), x_px=20)
    other = MadeTrack(4, "right", 1, {1: 0.5}, x_px=50)
    assert _label_again(store, page, (one, other), ()) == []
    assert page.merge(2, 4)["state"] == "accepted"


def test_a_second_decision_about_the_same_objects_replaces_the_first(store: Store, page: Page) -> None:
    page.decide("accept", 3, 4)
    page.decide("reject", 3, 4)
    _label_again(store, page, *renumbered())
    assert (page.merge(7, 15)["state"], page.merge(7, 15)["decided_by"]) == ("rejected", "person")
