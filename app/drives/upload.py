"""Taking in a drive that is sent as an archive.

The body streams to a file in a temporary folder, is unpacked beside it, and moves into the workspace in one step. When
anything goes wrong, nothing is left. A temporary folder is locked while in use, so that one without a lock is known to
be left over from a server that died.
"""

import fcntl
import re
import shutil
from collections.abc import AsyncIterator, Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import IO
from uuid import uuid4

from fastapi.concurrency import run_in_threadpool
from starlette.datastructures import Headers
from starlette.requests import ClientDisconnect

from app.db.session import Store
from app.drives import service
from app.drives.archive import CHUNK_BYTES, UnpackLimits, require_free_disk, unpack
from app.drives.schemas import Drive
from app.errors import BadArchive, UploadIncomplete, UploadTooLarge
from app.settings import Settings

_ARCHIVE_SUFFIX = re.compile(r"\.(zip|tar|tgz|tbz2?|txz|tar\.(gz|bz2|xz))$", re.IGNORECASE)
_LOCK = ".lock"


async def receive_drive(
    body: AsyncIterator[bytes], headers: Headers, filename: str, *, store: Store, settings: Settings
) -> Drive:
    """Take in a drive, and queue labelling where a model suits it.

    Raises UploadTooLarge, DiskFull, BadArchive, UploadIncomplete, or UnusableDrive."""
    _require_size(int(headers.get("content-length") or 0), settings)
    with _temporary_folder(settings.uploads_folder) as folder:
        archive = folder / "archive"
        with archive.open("xb") as file:
            await _receive(body, file, settings)
        return await run_in_threadpool(_take_in, archive, _name_of(filename), store, settings)


def remove_leftovers(settings: Settings) -> None:
    """Delete the temporary folders of servers that died."""
    if not settings.uploads_folder.is_dir():
        return
    for folder in settings.uploads_folder.iterdir():
        with (folder / _LOCK).open("a") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue  # another server is receiving it
            shutil.rmtree(folder, ignore_errors=True)


async def _receive(body: AsyncIterator[bytes], file: IO[bytes], settings: Settings) -> None:
    """Write the body to a file, in threads, a good piece at a time."""
    received = 0
    waiting = bytearray()

    def flush() -> None:
        require_free_disk(settings.uploads_folder, settings.min_free_bytes + len(waiting))
        file.write(waiting)
        waiting.clear()

    try:
        async for chunk in body:
            received += len(chunk)
            _require_size(received, settings)
            waiting += chunk
            if len(waiting) >= CHUNK_BYTES:
                await run_in_threadpool(flush)
        await run_in_threadpool(flush)
    except ClientDisconnect as error:
        raise UploadIncomplete(f"The upload broke off after {received:,} bytes. Upload the drive again.") from error
    if received == 0:
        raise BadArchive("The upload is empty. Send the archive as the request's body.")


def _take_in(archive: Path, name: str, store: Store, settings: Settings) -> Drive:
    """Unpack, move into place, store."""
    content = archive.with_name("content")
    limits = UnpackLimits(
        max_files=settings.max_files,
        max_bytes=settings.max_unpacked_bytes,
        max_ratio=settings.max_unpack_ratio,
        min_free_bytes=settings.min_free_bytes,
    )
    unpack(archive, content, limits=limits)
    archive.unlink()
    with _new_folder(settings.drives_folder, name) as folder:
        content.replace(folder)
        recorded = service.open_recorded_drive(folder)
        path = recorded.root.relative_to(settings.workspace.resolve())
        with store.write() as session:
            row = service.add_drive(session, recorded, path=str(path), scene=None, uploaded=True)
            service.queue_if_suited(session, settings, row.id)
            return service.drive_of(session, row)


@contextmanager
def _temporary_folder(parent: Path) -> Iterator[Path]:
    """A locked folder that is gone afterwards."""
    folder = parent / uuid4().hex
    folder.mkdir(parents=True)
    try:
        with (folder / _LOCK).open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@contextmanager
def _new_folder(parent: Path, name: str) -> Iterator[Path]:
    """A new folder of that name, or of that name and a number; gone again when an error leaves the block."""
    parent.mkdir(parents=True, exist_ok=True)
    number = 1
    while True:
        folder = parent / (name if number == 1 else f"{name}-{number}")
        try:
            folder.mkdir()
            break
        except FileExistsError:
            number += 1
    try:
        yield folder
    except BaseException:  # a stop by Ctrl-C too: no half of a drive stays
        shutil.rmtree(folder, ignore_errors=True)
        raise


def _require_size(size: int, settings: Settings) -> None:
    if size > settings.max_upload_bytes:
        raise UploadTooLarge(
            f"The archive is larger than {settings.max_upload_bytes:,} bytes, the most that this server takes. "
            "Register the folder instead, or raise HINDSIGHT_MAX_UPLOAD_BYTES."
        )


def _name_of(filename: str) -> str:
    """A folder's name from an archive's: letters, digits, dot, dash and underscore."""
    stem = _ARCHIVE_SUFFIX.sub("", PurePosixPath(filename.replace("\\", "/")).name)
    return re.sub(r"[^A-Za-z0-9._-]+", "_", stem).strip("._-")[:80] or "drive"
