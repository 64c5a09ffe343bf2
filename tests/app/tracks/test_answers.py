"""What the browser keeps of the labels, and how answers are packed."""

import pytest

from tests.app.conftest import Page

LISTS = ("tracks", "tracks/runs", "identities", "merges", "facts", "histogram")


@pytest.mark.parametrize("name", LISTS)
def test_what_the_browser_has_is_not_sent_again_until_labels_change(page: Page, name: str) -> None:
    path = f"/api/drives/{page.drive_id}/{name}"
    first = page.client.get(path)
    known = {"If-None-Match": f'"another", {first.headers["etag"]}'}
    assert first.headers["cache-control"] == "no-cache"
    again = page.client.get(path, headers=known)
    assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", first.headers["etag"])
    page.decide("accept", 3, 4)
    changed = page.client.get(path, headers=known)
    assert (changed.status_code, changed.headers["etag"] != first.headers["etag"]) == (200, True)


@pytest.mark.parametrize("name", LISTS)
def test_a_drive_that_is_not_there(page: Page, name: str) -> None:
    assert page.client.get(f"/api/drives/99/{name}").status_code == 404


def test_large_answers_are_compressed_where_that_is_asked_for(page: Page) -> None:
    path = f"/api/drives/{page.drive_id}/observations?start=0&stop=6"
    packed = page.client.get(path, headers={"Accept-Encoding": "gzip"})
    plain = page.client.get(path, headers={"Accept-Encoding": "identity"})
    assert packed.headers["content-encoding"] == "gzip"
    assert int(packed.headers["content-length"]) < len(plain.content) / 4
    assert packed.json() == plain.json()
    small = page.client.get("/api/health", headers={"Accept-Encoding": "gzip"})
    assert "content-encoding" not in small.headers
