"""Unpacking archives that nobody vouches for.

A member is written only when it is a plain file or folder, its path stays inside the target, and no other member has
the same path in any spelling of letter case. Sizes in headers are not believed: what counts is what is really written,
against a limit in bytes, a limit relative to the archive's size, and the disk's free space. Nothing but content is
taken over: no owner, no rights, no times.
"""

import bz2
import errno
import gzip
import lzma
import os
import shutil
import stat
import tarfile
import unicodedata
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import IO, cast

from app.errors import BadArchive, DiskFull, UploadTooLarge

CHUNK_BYTES = 1024 * 1024
FREE_UNPACK_BYTES = 64 * 1024**2
"""Archives may unpack to this much whatever their own size is."""
MAX_HEADER_BYTES = 16 * CHUNK_BYTES
MAX_PATH_PARTS = 32


@dataclass(frozen=True)
class UnpackLimits:
    """How much an archive may unpack to."""

    max_files: int
    max_bytes: int
    max_ratio: float
    min_free_bytes: int


def unpack(archive: Path, target: Path, *, limits: UnpackLimits) -> None:
    """Unpack a zip or tar (plain, gzip, bzip2, xz) into the folder ``target``, which is made.

    Raises BadArchive, UploadTooLarge or DiskFull; what has been written until then stays, for the caller to remove.
    """
    target.mkdir(parents=True)
    writer = _Writer(target, limits, archive_bytes=archive.stat().st_size)
    try:
        with archive.open("rb") as file:
            start = file.read(6)
        if start.startswith(b"PK"):
            _unpack_zip(archive, writer)
        else:
            _unpack_tar(archive, start, writer)
    except NotImplementedError as error:  # zipfile's word for a method of compression that it does not know
        raise BadArchive(f"The archive can't be read here: {error}. Pack it as an ordinary zip or tar.gz.") from error
    except (zipfile.BadZipFile, tarfile.TarError, zlib.error, lzma.LZMAError, EOFError) as error:
        raise BadArchive(f"The archive is damaged: {error}. Pack it again and upload it again.") from error
    except OSError as error:
        raise _from_os_error(error) from error
    if writer.file_count == 0:
        raise BadArchive("The archive holds no files.")


def _unpack_zip(archive: Path, writer: "_Writer") -> None:
    with zipfile.ZipFile(archive) as content:
        for info in content.infolist():
            kind = stat.S_IFMT(info.external_attr >> 16)
            if info.flag_bits & 0x1:
                raise BadArchive(f"{info.filename!r} in the archive is encrypted. Pack it without a password.")
            if kind not in (0, stat.S_IFREG, stat.S_IFDIR):
                raise BadArchive(_not_plain(info.filename))
            if info.is_dir():
                writer.add_folder(info.filename)
            else:
                with content.open(info) as source:
                    writer.add_file(info.filename, source)


def _unpack_tar(archive: Path, start: bytes, writer: "_Writer") -> None:
    with _open_stream(archive, start) as stream, _open_tar(stream) as content:
        for info in content:
            if info.isdir():
                writer.add_folder(info.name)
            elif info.isreg():
                source = content.extractfile(info)
                assert source is not None
                with source:
                    writer.add_file(info.name, source)
            else:
                raise BadArchive(_not_plain(info.name))


def _open_tar(stream: IO[bytes]) -> tarfile.TarFile:
    try:
        return tarfile.open(fileobj=cast(IO[bytes], _Bounded(stream)), mode="r:")
    except (tarfile.TarError, EOFError, OSError, zlib.error, lzma.LZMAError) as error:
        message = "The upload is neither a zip nor a tar archive. Pack the drive's folder as one."
        raise BadArchive(message) from error


def _open_stream(archive: Path, start: bytes) -> IO[bytes]:
    """The archive's bytes, decompressed as they are read."""
    if start.startswith(b"\x1f\x8b"):
        return cast(IO[bytes], gzip.open(archive))
    if start.startswith(b"BZh"):
        return cast(IO[bytes], bz2.open(archive))
    if start.startswith(b"\xfd7zXZ\x00"):
        return cast(IO[bytes], lzma.open(archive))
    return archive.open("rb")


class _Bounded:
    """A stream that refuses to read much at once: tarfile reads a header whole, however large it says it is."""

    def __init__(self, stream: IO[bytes]) -> None:
        self._stream = stream

    def read(self, size: int = -1) -> bytes:
        if not 0 <= size <= MAX_HEADER_BYTES:
            raise BadArchive("A header in the archive is larger than any real one. Pack the drive's folder again.")
        return self._stream.read(size)

    def seek(self, offset: int, whence: int = 0) -> int:
        return self._stream.seek(offset, whence)

    def tell(self) -> int:
        return self._stream.tell()


class _Writer:
    """Writes members below a folder, and keeps the limits."""

    def __init__(self, target: Path, limits: UnpackLimits, *, archive_bytes: int) -> None:
        self._target = target
        self._limits = limits
        self._max_bytes = min(limits.max_bytes, max(FREE_UNPACK_BYTES, int(archive_bytes * limits.max_ratio)))
        self._bytes = 0
        self._entries = 0
        self._folders: dict[str, str] = {}
        self._files: set[str] = set()
        self.file_count = 0

    def add_folder(self, name: str) -> None:
        self._count_entry()
        self._make_folder(_safe_path(name), name)

    def add_file(self, name: str, source: IO[bytes]) -> None:
        self._count_entry()
        path = _safe_path(name)
        if not path.parts:
            raise BadArchive(f"{name!r} in the archive is a file without a name.")
        self._make_folder(path.parent, name)
        key = _key(path)
        if key in self._files or key in self._folders:
            raise BadArchive(f"{name!r} is in the archive twice, or differs from another name by letter case only.")
        self._files.add(key)
        self.file_count += 1
        with (self._target / path).open("xb") as file:
            while chunk := source.read(CHUNK_BYTES):
                self._count_bytes(len(chunk))
                file.write(chunk)

    def _make_folder(self, path: PurePosixPath, name: str) -> None:
        for depth in range(1, len(path.parts) + 1):
            folder = PurePosixPath(*path.parts[:depth])
            key = _key(folder)
            if key in self._files or self._folders.setdefault(key, str(folder)) != str(folder):
                raise BadArchive(f"{name!r} in the archive lies at the place of another member. Rename one of them.")
        (self._target / path).mkdir(parents=True, exist_ok=True)

    def _count_entry(self) -> None:
        self._entries += 1
        if self._entries > self._limits.max_files:
            raise BadArchive(f"The archive holds more than {self._limits.max_files:,} files, the server's limit.")

    def _count_bytes(self, count: int) -> None:
        self._bytes += count
        if self._bytes > self._max_bytes:
            raise BadArchive(
                f"The archive unpacks to more than {self._max_bytes:,} bytes, which is more than this server takes for "
                "an archive of its size."
            )
        require_free_disk(self._target, self._limits.min_free_bytes + count)


def require_free_disk(folder: Path, needed_bytes: int) -> None:
    """Raise DiskFull unless the disk of ``folder`` has this much free."""
    if shutil.disk_usage(folder).free < needed_bytes:
        raise DiskFull(f"The disk of {folder} is nearly full. Free some space there and upload the drive again.")


def _from_os_error(error: OSError) -> BadArchive | DiskFull | UploadTooLarge:
    if error.errno in (errno.ENOSPC, errno.EDQUOT):
        return DiskFull("The disk is full. Free some space and upload the drive again.")
    if error.errno == errno.EFBIG:
        return UploadTooLarge("A file of the archive is larger than the disk's file system can hold.")
    return BadArchive(f"The archive can't be unpacked: {error.strerror or error}.")


def _safe_path(name: str) -> PurePosixPath:
    """The member's path inside the target; BadArchive where it would lead out of it or can't be a file's name."""
    path = PurePosixPath(name)
    unsafe = (
        path.is_absolute()
        or ".." in path.parts
        or "\\" in name
        or any(unicodedata.category(letter) == "Cc" for letter in name)
        or (len(name) > 1 and name[1] == ":")
        or len(path.parts) > MAX_PATH_PARTS
        or any(len(os.fsencode(part)) > 255 for part in path.parts)
    )
    if unsafe:
        raise BadArchive(f"{name!r} in the archive does not name a place inside it. Pack the drive's folder again.")
    return path


def _key(path: PurePosixPath) -> str:
    """The same for paths that some file system takes for one."""
    return unicodedata.normalize("NFKC", str(path)).casefold()


def _not_plain(name: str) -> str:
    return f"{name!r} in the archive is a link or a device. Pack the files themselves (tar -h follows links)."
