"""Corrections of the labels of tests/app/made_labels.py, as the page asks for them."""

from dataclasses import dataclass
from typing import Any
from urllib.parse import quote

import httpx
import pytest
from sqlalchemy import select

from app.db.session import Store
from app.tracks.models import Box3DRow
from tests.app.conftest import Page


@dataclass
class Editor:
    """Corrects the labels of a drive. Who did it last does the next too, where nobody is named."""

    page: Page
    store: Store
    reviewer: str | None = None

    def refused(
        self, kind: str, *, revision: int | None = None, reviewer: str | None = None, **content: Any
    ) -> httpx.Response:
        body = {"edit": {"kind": kind, **content}, "revision": revision}
        return self._post("edits", body, reviewer)

    def edit(self, kind: str, **content: Any) -> Any:
        answer = self.refused(kind, **content)
        assert answer.status_code == 200, answer.text
        return answer.json()

    def turned(self, verb: str, edit_id: int | None = None, *, reviewer: str | None = None) -> httpx.Response:
        return self._post(verb, {"edit_id": edit_id}, reviewer)

    def undo(self, edit_id: int | None = None, *, reviewer: str | None = None) -> Any:
        answer = self.turned("undo", edit_id, reviewer=reviewer)
        assert answer.status_code == 200, answer.text
        return answer.json()

    def redo(self, edit_id: int | None = None) -> Any:
        answer = self.turned("redo", edit_id)
        assert answer.status_code == 200, answer.text
        return answer.json()

    def log(self) -> Any:
        path = f"/api/drives/{self.page.drive_id}/edits"
        return self.page.client.get(path, headers=self._headers()).json()

    def identity(self, identity_id: int) -> Any:
        return next(one for one in self.page.get("identities") if one["id"] == identity_id)

    def tracks_in(self, camera: str) -> list[Any]:
        return [track for track in self.page.get("tracks") if track["camera"] == camera]

    def frame(self, frame_index: int) -> list[Any]:
        return self.page.get("observations", start=frame_index, stop=frame_index + 1)["frames"][0]["observations"]

    def revision(self) -> int:
        return self.page.client.get(f"/api/drives/{self.page.drive_id}").json()["revision"]

    def boxes_3d(self) -> set[tuple[int, int]]:
        """Frame and track of the 3D boxes that a track has."""
        with self.store.read() as session:
            rows = session.execute(select(Box3DRow.frame_index, Box3DRow.track_id)).all()
        return {(frame, track) for frame, track in rows if track is not None}

    def _post(self, verb: str, body: Any, reviewer: str | None) -> httpx.Response:
        self.reviewer = reviewer or self.reviewer
        path = f"/api/drives/{self.page.drive_id}/{verb}"
        return self.page.client.post(path, json=body, headers=self._headers())

    def _headers(self) -> dict[str, str]:
        return {"Hindsight-Reviewer": quote(self.reviewer)} if self.reviewer else {}


@pytest.fixture
def editor(page: Page, store: Store) -> Editor:
    return Editor(page, store)
