"""Pulling a model by name: the one thing in this project that downloads."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO
from urllib.parse import urlsplit

from labeler.inference import ModelError
from labeler.models.cache import ModelCache, Record, sha256_of
from labeler.models.download import PullProgress, download, forget_part, open_part
from labeler.models.errors import ModelStoreError, WrongBytes
from labeler.models.inspection import Inspected, inspect
from labeler.models.registry import OFFICIAL, SHIPPED, OfficialModel


@dataclass(frozen=True)
class Pulled:
    """What came of a pull. ``fresh``: it was downloaded now. ``pinned``: its sha256 is that of the published file,
    else it is the one that was found on first use."""

    record: Record
    path: Path
    fresh: bool
    pinned: bool


def pull(
    name: str,
    cache: ModelCache,
    *,
    progress: PullProgress,
    mirror: str | None = None,
    official: Sequence[OfficialModel] = OFFICIAL,
    opening: Callable[[Path, str], IO[bytes]] = open_part,
) -> Pulled:
    """Bring an ``official`` model into the cache, unless it is there.

    ``mirror`` is the address of a folder that holds the official files by their own names. Two pulls of one model at
    once make one download. Raises ModelStoreError for a name that is not official, PullError for what goes wrong."""
    model = _official(name, official)
    url = f"{_checked_mirror(mirror)}/{model.file}" if mirror else model.url
    with cache.lock(name, on_wait=progress.waiting):
        known = cache.find(name)
        if known is not None and model.sha256 in (None, known.sha256):
            return Pulled(known, cache.path(name), fresh=False, pinned=model.sha256 is not None)
        part = cache.folder / f"{name}.onnx.part"
        with cache.errors():
            download(url, part, expected_bytes=model.size_bytes, progress=progress, opening=opening)
            digest = sha256_of(part)
        inspected = _checked(part, model, digest, url)
        record = cache.keep(part, name, inspected, sha256=digest, source=url, licence=model.licence)
        forget_part(part)
        return Pulled(record, cache.path(name), fresh=True, pinned=model.sha256 is not None)


def _official(name: str, official: Sequence[OfficialModel]) -> OfficialModel:
    for model in official:
        if model.name == name:
            return model
    can = ", ".join(model.name for model in official)
    if name in {model.name for model in SHIPPED}:
        raise ModelStoreError(f"{name} ships with Hindsight: there is nothing to pull. These can be pulled: {can}.")
    raise ModelStoreError(f"There is no model {name} to pull. There are: {can}.")


def _checked(part: Path, model: OfficialModel, digest: str, url: str) -> Inspected:
    """What the part is, once it is the published file and can be run. Else WrongBytes, and the part is gone."""
    if model.sha256 not in (None, digest):
        forget_part(part)
        raise WrongBytes(
            f"The file from {url} is not the published {model.name}: its sha256 is {digest}, which should be "
            f"{model.sha256}. It was deleted. Pull again; if it happens again, the source holds another file."
        )
    try:
        inspected = inspect(part)
    except ModelError as error:
        forget_part(part)
        raise WrongBytes(f"The file from {url} can't be used and was deleted. {error}") from error
    if inspected.task != model.task:
        forget_part(part)
        raise WrongBytes(f"The file from {url} does {inspected.task}, not {model.task}, and was deleted.")
    return inspected


def _checked_mirror(mirror: str) -> str:
    parts = urlsplit(mirror)
    if parts.scheme not in ("http", "https") or not parts.netloc:
        raise ModelStoreError(
            f"HINDSIGHT_MODEL_MIRROR is {mirror!r}, and must be an address that begins with https:// or http://. Files "
            "on this machine are added by: hindsight models add FILE --as NAME."
        )
    return mirror.rstrip("/")
