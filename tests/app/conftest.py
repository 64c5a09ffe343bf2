"""The real app on a workspace of its own, with a tiny drive in it."""

import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import make_url

from app.db.engine import migrate, open_engine
from app.db.session import Store
from app.drives.schemas import DriveRegistration
from app.drives.service import add_local_drive
from app.main import create_app
from app.settings import Settings
from app.tracks.importing import import_labelled_drive
from tests.app.browser import Browser, browser_on
from tests.app.made_labels import make_labelled_drive, write_three_camera_drive


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    return Settings(
        workspace=tmp_path / "workspace", models=tmp_path / "models", min_free_bytes=0, job_poll_seconds=0.01
    )


@pytest.fixture(scope="session")
def migrated_store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of a migrated store without anything in it."""
    path = tmp_path_factory.mktemp("store") / "hindsight.db"
    engine = open_engine(f"sqlite:///{path}")
    migrate(engine)
    engine.dispose()
    return path


@pytest.fixture
def store(settings: Settings, migrated_store: Path) -> Iterator[Store]:
    """The migrated store of the workspace."""
    url = make_url(settings.store_url)
    assert url.database is not None
    settings.workspace.mkdir(exist_ok=True)
    shutil.copy(migrated_store, url.database)
    engine = open_engine(settings.store_url)
    yield Store(engine)
    engine.dispose()


@pytest.fixture
def client(settings: Settings) -> Iterator[Browser]:
    """A browser on the app."""
    with browser_on(create_app(settings)) as client:
        yield client


@pytest.fixture(scope="session")
def three_camera_drive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A drive with cameras front, left and right, 6 frames; see tests/app/made_labels.py."""
    return write_three_camera_drive(tmp_path_factory.mktemp("drives") / "three cameras")


@pytest.fixture
def drive_id(store: Store, three_camera_drive: Path) -> int:
    """A registered drive without labels."""
    return add_local_drive(store, DriveRegistration(path=str(three_camera_drive))).id


@pytest.fixture
def labelled_id(store: Store, drive_id: int) -> int:
    """A registered drive with the labels of tests/app/made_labels.py."""
    assert import_labelled_drive(store, drive_id, make_labelled_drive(), model_name="made")
    return drive_id


@dataclass(frozen=True)
class Page:
    """What the page shows of a drive, as it asks the server."""

    client: Browser
    drive_id: int

    def get(self, what: str, **params: Any) -> Any:
        answer = self.client.get(f"/api/drives/{self.drive_id}/{what}", params=params)
        assert answer.status_code == 200, answer.text
        return answer.json()

    def labels(self) -> dict[tuple[int, int], tuple[str, float, str, int]]:
        """(class, score, source, identity) by track and frame."""
        return {
            (seen["track_id"], frame["frame_index"]): (
                seen["label"]["class_name"],
                seen["label"]["score"],
                seen["label"]["source"],
                seen["identity_id"],
            )
            for frame in self.get("observations", start=0, stop=6)["frames"]
            for seen in frame["observations"]
        }

    def merge(self, track_a: int, track_b: int) -> dict[str, Any]:
        (merge,) = (m for m in self.get("merges") if (m["track_a"], m["track_b"]) == (track_a, track_b))
        return merge

    def decide(self, verb: str, track_a: int, track_b: int) -> Any:
        answer = self.client.post(f"/api/merges/{self.merge(track_a, track_b)['id']}/{verb}")
        assert answer.status_code == 200, answer.text
        return answer.json()

    def everything(self) -> Any:
        """All that a decision can change, but the revision and who decided."""
        merges = [{k: v for k, v in merge.items() if k != "decided_by"} for merge in self.get("merges")]
        return (self.get("observations", start=0, stop=6)["frames"], self.get("identities"), self.get("tracks"), merges)


@pytest.fixture
def page(client: Browser, labelled_id: int) -> Page:
    return Page(client, labelled_id)
