"""The models that were pulled or added: a folder with one .onnx file each, and a record beside it.

The record says where the file came from and which sha256 it had then. A model is there when both files are; each
appears whole, the record first.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import hashlib
import json
import os
import re
import shutil
import uuid
from collections.abc import Callable, Generator
from dataclasses import asdict, dataclass
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from labeler.models.errors import DiskFull, ModelStoreError
from labeler.models.inspection import Inspected, inspect
from labeler.models.registry import Task, registered_names

_CHUNK_BYTES = 1 << 20
_NAME = re.compile(r"[a-z0-9][a-z0-9._-]{0,63}")


@dataclass(frozen=True)
class Record:
    """What is known of a model in the cache; ``source`` is an address, or the file that it was copied from."""

    name: str
    task: Task
    sha256: str
    size_bytes: int
    source: str
    licence: str
    input_shape: str
    class_names: tuple[str, ...]


class ModelCache:
    """The models in one folder, which is made when it is first written to."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def records(self) -> list[Record]:
        """Every model that is there, by name. A record that can't be read counts as none."""
        found = (self.find(path.stem) for path in sorted(self.folder.glob("*.json")))
        return [record for record in found if record is not None]

    def find(self, name: str) -> Record | None:
        """The record of a model; None where the model is not there."""
        try:
            record = TypeAdapter(Record).validate_json(self._record_path(name).read_bytes())
        except (OSError, ValidationError):
            return None
        return record if record.name == name and self.path(name).is_file() else None

    def path(self, name: str) -> Path:
        """Where the file of that model lies, or will lie."""
        return self.folder / f"{name}.onnx"

    def add(self, file: Path, name: str, *, licence: str = "not stated") -> Record:
        """Copy a model file of the user's into the cache under a name of its own.

        Raises ModelError for a file that is no model, ModelStoreError for a name that can't be used or is taken."""
        if not _NAME.fullmatch(name):
            raise ModelStoreError(
                f"{name!r} can't be the name of a model. Use up to 64 small letters, digits, dots, hyphens and "
                "underscores, beginning with a letter or a digit."
            )
        if name in registered_names():
            raise ModelStoreError(f"{name} is the name of a model of Hindsight's registry. Choose another name.")
        inspected = inspect(file)
        with self.lock(name), self._temporary(name) as copy:
            with self.errors():
                shutil.copyfile(file, copy)
            digest = sha256_of(copy)
            known = self.find(name)
            if known is not None and known.sha256 != digest:
                raise ModelStoreError(
                    f"There is another model {name} in {self.folder}. Choose another name, or delete "
                    f"{self.path(name)} first."
                )
            return self.keep(copy, name, inspected, sha256=digest, source=str(file.absolute()), licence=licence)

    def keep(
        self, temporary: Path, name: str, inspected: Inspected, *, sha256: str, source: str, licence: str
    ) -> Record:
        """Move a whole, checked file of this folder to its place, and write down what it is."""
        size_bytes = temporary.stat().st_size
        record = Record(
            name, inspected.task, sha256, size_bytes, source, licence, inspected.input_shape, inspected.class_names
        )
        with self._temporary(name) as written, self.errors():
            written.write_text(json.dumps(asdict(record), indent=1), encoding="utf-8")
            written.replace(self._record_path(name))
            temporary.replace(self.path(name))
        return record

    @contextlib.contextmanager
    def lock(self, name: str, *, on_wait: Callable[[], None] | None = None) -> Generator[None]:
        """Hold a model's lock, which processes on this machine share; ``on_wait`` is called once if another has it."""
        with self.errors():
            self.folder.mkdir(parents=True, exist_ok=True)
            descriptor = os.open(self.folder / f".{name}.lock", os.O_RDWR | os.O_CREAT, 0o644)
        try:
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                if on_wait is not None:
                    on_wait()
                fcntl.flock(descriptor, fcntl.LOCK_EX)
            yield
        finally:
            os.close(descriptor)

    @contextlib.contextmanager
    def errors(self) -> Generator[None]:
        """Turns what the system says about the folder into a sentence with what to do."""
        try:
            yield
        except OSError as error:
            if error.errno in (errno.ENOSPC, errno.EDQUOT):
                raise DiskFull(
                    f"The disk that holds {self.folder} is full. Free some space, or name another folder by "
                    "HINDSIGHT_MODELS, and run the same command again."
                ) from error
            if isinstance(error, PermissionError | NotADirectoryError | FileExistsError) or error.errno == errno.EROFS:
                raise ModelStoreError(
                    f"Can't write to {self.folder}: {error.strerror}. Name a folder that you may write to by "
                    "HINDSIGHT_MODELS."
                ) from error
            raise

    def _record_path(self, name: str) -> Path:
        return self.folder / f"{name}.json"

    @contextlib.contextmanager
    def _temporary(self, name: str) -> Generator[Path]:
        path = self.folder / f".{name}.{uuid.uuid4().hex[:8]}.tmp"
        try:
            yield path
        finally:
            path.unlink(missing_ok=True)


def sha256_of(path: Path) -> str:
    """The sha256 of a file's content, in hexadecimal."""
    content = hashlib.sha256()
    with path.open("rb") as file:
        while chunk := file.read(_CHUNK_BYTES):
            content.update(chunk)
    return content.hexdigest()
