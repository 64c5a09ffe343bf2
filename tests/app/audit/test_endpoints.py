"""Audits over HTTP: the last one of the labels as they are."""

from app.audit import repository
from app.db.session import Store
from app.tracks import repository as tracks_repository
from app.tracks.importing import import_labelled_drive
from labeler.evaluation.audit import Audit, AuditRow, agreement
from tests.app.conftest import Page
from tests.app.made_labels import make_labelled_drive


def made_audit(seed: int) -> Audit:
    box, label = agreement(30, 40), agreement(27, 30)
    return Audit(
        drive="made",
        share=0.05,
        confidence=0.8,
        seed=seed,
        iou=0.5,
        confident=800,
        hidden=40,
        box=box,
        label=label,
        by_distance=[],
        by_height=[AuditRow(start=160.0, stop=None, box=box, label=label)],
    )


def put(store: Store, drive_id: int, audit: Audit) -> None:
    with store.write() as session:
        labelling = tracks_repository.current_labelling(session, drive_id)
        assert labelling is not None
        repository.put(session, labelling.id, audit)


def test_there_is_none_before_the_first(page: Page) -> None:
    assert page.get("audit") is None


def test_the_last_one_of_the_labels_as_they_are(page: Page, store: Store) -> None:
    put(store, page.drive_id, made_audit(1))
    put(store, page.drive_id, made_audit(2))
    found = page.get("audit")
    assert found.pop("created_at")
    assert found == made_audit(2)

    # other labels have none yet
    assert import_labelled_drive(store, page.drive_id, make_labelled_drive(key="second"), model_name="made")
    assert page.get("audit") is None


def test_a_drive_that_is_not_there(page: Page) -> None:
    assert page.client.get("/api/drives/99/audit").status_code == 404
