"""Whether the model files on this machine are still those that were published, or taken in."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from labeler.models.cache import ModelCache, sha256_of
from labeler.models.registry import OFFICIAL, SHIPPED


@dataclass(frozen=True)
class Verdict:
    """``expected`` is the sha256 that was published, or recorded on first use; ``found`` is the file's, None where it
    can't be read."""

    name: str
    path: Path
    expected: str
    found: str | None

    @property
    def is_right(self) -> bool:
        return self.expected == self.found


def verify(cache: ModelCache) -> Iterator[Verdict]:
    """Hash every model that ships and every model in the cache, one after the other."""
    published = {model.name: model.sha256 for model in OFFICIAL}
    for model in SHIPPED:
        yield Verdict(model.name, model.path, model.sha256, _hash(model.path))
    for record in cache.records():
        path = cache.path(record.name)
        yield Verdict(record.name, path, published.get(record.name) or record.sha256, _hash(path))


def _hash(path: Path) -> str | None:
    try:
        return sha256_of(path)
    except OSError:
        return None
