"""Uploads over HTTP: what arrives, and that nothing is left of what does not."""

import shutil
from collections.abc import AsyncIterator
from pathlib import Path

import anyio
import httpx
import pytest
from starlette.datastructures import Headers
from starlette.requests import ClientDisconnect

from app.db.session import Store
from app.drives.upload import receive_drive, remove_leftovers
from app.errors import UploadIncomplete
from app.main import create_app
from app.settings import Settings
from tests.app.browser import Browser, browser_on


@pytest.fixture
def archive(three_camera_drive: Path, tmp_path: Path) -> Path:
    """The drive as a zip, with its folder in it."""
    name = shutil.make_archive(
        str(tmp_path / "archive"), "zip", three_camera_drive.parent, base_dir=three_camera_drive.name
    )
    return Path(name)


def _upload(client: Browser, content: bytes, filename: str = "my drive.zip") -> httpx.Response:
    return client.post("/api/drives/upload", params={"filename": filename}, content=content)


def _left_in(settings: Settings) -> list[Path]:
    return [path for folder in (settings.uploads_folder, settings.drives_folder) for path in folder.glob("*")]


def test_an_uploaded_drive_is_there_whole(client: Browser, settings: Settings, archive: Path) -> None:
    answer = _upload(client, archive.read_bytes())
    assert answer.status_code == 201, answer.text
    drive = answer.json()
    assert (drive["name"], drive["state"], drive["uploaded"], drive["job"]) == ("three cameras", "new", True, None)
    assert (drive["frame_count"], drive["duration_ms"], drive["has_lidar"]) == (6, 500.0, True)
    assert drive["camera_names"] == ["front", "left", "right"]
    assert _left_in(settings) == [settings.drives_folder / "my_drive"]
    image = client.get(f"/api/drives/{drive['id']}/frames/5/images/left")
    assert image.status_code == 200


def test_the_same_archive_twice_is_two_drives(client: Browser, settings: Settings, archive: Path) -> None:
    for _ in range(2):
        assert _upload(client, archive.read_bytes()).status_code == 201
    assert {path.name for path in settings.drives_folder.iterdir()} == {"my_drive", "my_drive-2"}
    assert len(client.get("/api/drives").json()) == 2


def test_labelling_is_queued_where_a_model_is_configured(settings: Settings, archive: Path, made_model: Path) -> None:
    with browser_on(create_app(settings.model_copy(update={"model": str(made_model)}))) as client:
        drive = _upload(client, archive.read_bytes()).json()
    assert (drive["state"], drive["job"]["kind"], drive["job"]["state"]) == ("queued", "label", "queued")


def test_deleting_an_uploaded_drive_deletes_its_copy(client: Browser, settings: Settings, archive: Path) -> None:
    drive_id = _upload(client, archive.read_bytes()).json()["id"]
    assert client.delete(f"/api/drives/{drive_id}").status_code == 204
    assert _left_in(settings) == []
    assert client.get(f"/api/drives/{drive_id}").status_code == 404


@pytest.mark.parametrize(
    ("content", "status", "code"),
    [
        (b"", 400, "bad_archive"),
        (b"this is no archive" * 100, 400, "bad_archive"),
        (b"x" * 200_001, 413, "upload_too_large"),
    ],
)
def test_what_is_refused_leaves_nothing(settings: Settings, content: bytes, status: int, code: str) -> None:
    with browser_on(create_app(settings.model_copy(update={"max_upload_bytes": 200_000}))) as client:
        answer = _upload(client, content)
    assert (answer.status_code, answer.json()["detail"]["code"]) == (status, code)
    assert _left_in(settings) == []


def test_an_archive_without_a_drive_leaves_nothing(client: Browser, settings: Settings, tmp_path: Path) -> None:
    (tmp_path / "letters").mkdir()
    (tmp_path / "letters" / "a.txt").write_text("hello")
    archive = shutil.make_archive(str(tmp_path / "letters"), "zip", tmp_path / "letters")
    answer = _upload(client, Path(archive).read_bytes())
    assert (answer.status_code, answer.json()["detail"]["code"]) == (422, "unusable_drive")
    assert "no drive of a known format" in answer.json()["detail"]["message"]
    assert _left_in(settings) == []
    assert client.get("/api/drives").json() == []


def test_a_full_disk_leaves_nothing(settings: Settings, archive: Path) -> None:
    with browser_on(create_app(settings.model_copy(update={"min_free_bytes": 10**18}))) as client:
        answer = _upload(client, archive.read_bytes())
    assert (answer.status_code, answer.json()["detail"]["code"]) == (507, "disk_full")
    assert _left_in(settings) == []


def test_a_size_that_is_said_to_be_too_large_is_refused_before_it_is_read(store: Store, settings: Settings) -> None:
    async def body() -> AsyncIterator[bytes]:
        pytest.fail("the body was read")
        yield b""

    small = settings.model_copy(update={"max_upload_bytes": 10})
    headers = Headers({"content-length": "11"})
    with pytest.raises(Exception, match="larger than 10 bytes"):
        anyio.run(lambda: receive_drive(body(), headers, "a.zip", store=store, settings=small))


def test_a_sender_that_goes_away_leaves_nothing(store: Store, settings: Settings, archive: Path) -> None:
    async def body() -> AsyncIterator[bytes]:
        yield archive.read_bytes()[:1000]
        raise ClientDisconnect

    with pytest.raises(UploadIncomplete, match="after 1,000 bytes"):
        anyio.run(lambda: receive_drive(body(), Headers(), "a.zip", store=store, settings=settings))
    assert _left_in(settings) == []


def test_a_cancelled_upload_leaves_nothing(store: Store, settings: Settings, archive: Path) -> None:
    async def receive_and_cancel() -> None:
        with anyio.CancelScope() as scope:

            async def body() -> AsyncIterator[bytes]:
                yield archive.read_bytes()[:1000]
                scope.cancel()
                await anyio.sleep_forever()

            await receive_drive(body(), Headers(), "a.zip", store=store, settings=settings)

    anyio.run(receive_and_cancel)
    assert _left_in(settings) == []


def test_leftovers_of_a_server_that_died_are_removed_and_running_uploads_are_not(
    store: Store, settings: Settings, archive: Path
) -> None:
    leftover = settings.uploads_folder / "left over"
    leftover.mkdir(parents=True)
    (leftover / "archive").write_bytes(b"half")

    async def body() -> AsyncIterator[bytes]:
        content = archive.read_bytes()
        yield content[:1000]
        remove_leftovers(settings)
        yield content[1000:]

    drive = anyio.run(lambda: receive_drive(body(), Headers(), "a.zip", store=store, settings=settings))
    assert drive.name == "three cameras"
    assert not leftover.exists()


@pytest.mark.parametrize(
    ("filename", "folder"),
    [
        ("a.tar.gz", "a"),
        ("../../etc/x.zip", "x"),
        ("..\\x.tgz", "x"),
        (".zip", "drive"),
        ("été 1.zip", "t_1"),
        ("y" * 200 + ".tar", "y" * 80),
    ],
)
def test_names_of_folders(client: Browser, settings: Settings, archive: Path, filename: str, folder: str) -> None:
    assert _upload(client, archive.read_bytes(), filename).status_code == 201
    assert [path.name for path in settings.drives_folder.iterdir()] == [folder]
