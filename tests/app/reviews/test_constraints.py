"""Decisions as the next run of the pipeline takes them."""

from app.db.session import Store
from app.reviews.constraints import constraints_about
from labeler.identity import Decisions
from tests.app.conftest import Page


def _said(store: Store, page: Page) -> Decisions:
    with store.read() as session:
        return constraints_about(session, page.drive_id)


def test_accepted_and_rejected_merges_name_their_tracks_by_a_box(store: Store, page: Page) -> None:
    page.decide("accept", 3, 4)
    page.decide("reject", 1, 2)
    page.decide("unsure", 2, 4)

    said = _said(store, page)

    ((left, right),) = said.same
    assert (left.camera, right.camera) == ("left", "right")
    ((front, left),) = said.different
    assert (front.camera, left.camera) == ("front", "left")
    assert all(len(anchor.frame_index) == len(anchor.xyxy_px) == 1 for anchor in (left, right, front))


def test_what_was_taken_back_holds_no_longer(store: Store, page: Page) -> None:
    page.decide("accept", 3, 4)
    page.decide("undo", 3, 4)
    assert _said(store, page) == Decisions()


def test_the_latest_word_counts(store: Store, page: Page) -> None:
    page.decide("accept", 3, 4)
    page.decide("reject", 3, 4)
    said = _said(store, page)
    assert (len(said.same), len(said.different)) == (0, 1)
