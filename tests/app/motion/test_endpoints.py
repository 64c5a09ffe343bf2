"""Facts about identities over HTTP."""

import pytest
from sqlalchemy import event

from app.db.session import Store
from app.motion.facts import FactsCache
from app.tracks import repository as tracks_repository
from tests.app.conftest import Page


def test_distances_of_identities(page: Page) -> None:
    facts = {one["identity_id"]: one for one in page.get("facts")}
    assert sorted(facts) == [1, 3, 4, 5]  # 1 and 2 are one
    # 12 m ahead, .5 m to the left, in every frame
    assert facts[1] == {"identity_id": 1, "nearest_m": 12.0, "farthest_m": 12.0, "purity": 0.95, "failed": []}
    assert (facts[3]["nearest_m"], facts[3]["farthest_m"]) == (None, None)


def test_facts_follow_decisions(page: Page) -> None:
    page.get("facts")
    page.decide("reject", 1, 2)
    assert [one["identity_id"] for one in page.get("facts")] == [1, 2, 3, 4, 5]


def test_what_has_not_changed_is_not_worked_out_again(store: Store, page: Page) -> None:
    cache = FactsCache()
    asked: list[str] = []

    def facts() -> int:
        """How often 3D boxes were asked for."""
        asked.clear()
        with store.read() as session:
            labelling = tracks_repository.current_labelling(session, page.drive_id)
            assert labelling is not None
            cache.facts_of(session, labelling)
        return sum("box3d" in statement for statement in asked)

    def note(_connection: object, _cursor: object, statement: str, *_: object) -> None:
        asked.append(statement)

    event.listen(store.engine, "before_cursor_execute", note)
    assert facts() == 1
    assert facts() == 0
    page.decide("reject", 1, 2)
    assert facts() == 1


@pytest.mark.parametrize("what", ["facts", "histogram"])
def test_no_such_drive(page: Page, what: str) -> None:
    assert page.client.get(f"/api/drives/999/{what}").status_code == 404


def test_distances_of_boxes(page: Page) -> None:
    found = page.get("observations", start=4, stop=5)["frames"][0]["observations"]
    ids = {one["track_id"]: one["id"] for one in found}
    # track 1 has a 3D box 12 m ahead and .5 m to the left; track 2 has none; there is no box of number 99999
    asked = "&".join(f"observation_id={number}" for number in (ids[1], ids[2], 99_999))
    answer = page.client.get(f"/api/drives/{page.drive_id}/distances?{asked}").json()
    assert {one["observation_id"]: one["distance_m"] for one in answer} == {ids[1]: 12.0, ids[2]: None}
