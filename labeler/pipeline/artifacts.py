"""Artifacts: files keyed by a hash of what they were made from, which appear whole or not at all.

An artifact lies at ``<workspace>/artifacts/<stage>/<key>.<suffix>``. It is written under a temporary name and then
``os.replace``d, so a file that is there is complete, a run that was killed resumes behind its last artifact, and two
runs at once at worst make the same file twice.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import json
import os
import uuid
from collections.abc import Callable, Generator, Iterable
from dataclasses import asdict, is_dataclass
from pathlib import Path

import psutil

from labeler.errors import HindsightError

_CHUNK_BYTES = 1 << 20


class WorkspaceError(HindsightError):
    """The workspace can't be written to: full, read-only, or no folder."""


def key_of(*parts: object) -> str:
    """A key for these parts: strings, numbers, None, lists, tuples, dicts and frozen dataclasses of such."""
    text = json.dumps(parts, sort_keys=True, separators=(",", ":"), default=_plain)
    return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()


class Artifacts:
    """The artifacts of one workspace.

    Raises WorkspaceError when the workspace can't be made.
    """

    def __init__(self, workspace: Path) -> None:
        self._root = workspace / "artifacts"
        with _workspace_errors(workspace):
            self._root.mkdir(parents=True, exist_ok=True)
        self._remove_leftovers()

    @property
    def root(self) -> Path:
        """The folder that all lie in."""
        return self._root

    def path(self, stage: str, key: str, suffix: str) -> Path:
        """Where that artifact lies, or will lie."""
        return self._root / stage / f"{key}.{suffix}"

    def make(self, path: Path, write: Callable[[Path], None]) -> Path:
        """Let ``write`` fill a temporary file, then put it at ``path`` in one step. Nothing is left when it fails."""
        temporary = path.with_name(f".{path.name}.{os.getpid()}.{uuid.uuid4().hex[:8]}.tmp")
        try:
            with _workspace_errors(path):
                path.parent.mkdir(parents=True, exist_ok=True)
                write(temporary)
                temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)
        return path

    def content_hash(self, files: Iterable[Path]) -> str:
        """A hash of these files' content, in this order.

        A file is read again only when its path, size or time of change differs from when it was last hashed, as in git.
        Files that can't be read count as absent; the step that opens them reports them.
        """
        names = list(files)
        stat_key = key_of([_stat_of(name) for name in names])
        known = self.path("content", stat_key, "txt")
        if known.exists():
            return known.read_text()
        content = hashlib.blake2b(digest_size=16)
        for name in names:
            content.update(_hash_file(name))
        digest = content.hexdigest()
        self.make(known, lambda temporary: _write_text(temporary, digest))
        return digest

    def _remove_leftovers(self) -> None:
        """Temporary files of processes that died."""
        for leftover in self._root.glob("*/.*.tmp"):
            pid = leftover.name.split(".")[-3]
            if pid.isdigit() and not psutil.pid_exists(int(pid)):
                leftover.unlink(missing_ok=True)


def write_json(path: Path, value: object) -> None:
    """Write ``value`` as JSON."""
    _write_text(path, json.dumps(value, default=_plain))


def _write_text(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")


def _plain(value: object) -> object:
    if is_dataclass(value) and not isinstance(value, type):
        return asdict(value)
    raise TypeError(f"{type(value).__name__} can't be part of an artifact's key")


def _stat_of(path: Path) -> tuple[str, int, int]:
    try:
        status = path.stat()
    except OSError:
        return (str(path), -1, -1)
    return (str(path.resolve()), status.st_size, status.st_mtime_ns)


def _hash_file(path: Path) -> bytes:
    content = hashlib.blake2b(digest_size=16)
    try:
        with path.open("rb") as file:
            while chunk := file.read(_CHUNK_BYTES):
                content.update(chunk)
    except OSError:
        return b""
    return content.digest()


@contextlib.contextmanager
def _workspace_errors(path: Path) -> Generator[None]:
    try:
        yield
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            message = f"The disk that holds {path} is full. Free some space, or name another workspace, and run again."
            raise WorkspaceError(message) from error
        if error.errno in (errno.EACCES, errno.EPERM, errno.EROFS, errno.ENOTDIR, errno.EEXIST):
            message = f"Can't write to {path}: {error.strerror}. Name a workspace folder that you may write to."
            raise WorkspaceError(message) from error
        raise
