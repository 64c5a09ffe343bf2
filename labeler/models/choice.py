"""Which model does the work: what the user names, else the best official one in the cache, else the one that ships.

Command line, worker and page all ask here.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from labeler.models.cache import ModelCache
from labeler.models.errors import ModelStoreError
from labeler.models.registry import OFFICIAL, SHIPPED, Task, registered_names

NO_SEGMENTATION = "none"
WITHOUT_WEIGHTS = "clusters"
"""3D boxes that need no network, by name."""


class Origin(StrEnum):
    """Where a model comes from."""

    OFFICIAL = "official"
    ADDED = "added"
    SHIPPED = "shipped"
    FILE = "file"


@dataclass(frozen=True)
class Choice:
    """A model file to work with; ``name`` is its registered one, or the file's."""

    name: str
    path: Path
    origin: Origin

    def notice(self, *, simulated: bool) -> str | None:
        """What a person must know before they trust what it says about a drive that is ``simulated`` or not."""
        return notice_of(self.name, simulated=simulated) if self.origin is Origin.SHIPPED else None


def notice_of(name: str, *, simulated: bool) -> str | None:
    """As :meth:`Choice.notice`, for a model of which only the name is known."""
    if simulated or name not in {model.name for model in SHIPPED}:
        return None
    return (
        f"{name} was trained on simulated drives and finds little on real roads. Get an official model: "
        f"hindsight models pull {OFFICIAL[-1].name}"
    )


def choose_detector(named: str | Path | None, cache: ModelCache) -> Choice:
    """The detector to use; ``named`` is a file, a registered name, or None.

    Raises ModelStoreError for a name that no model has, or that is not in the cache."""
    if named is not None:
        return _find(str(named), Task.DETECTION, cache)
    return available(Task.DETECTION, cache)[0]


def choose_named(name: str, cache: ModelCache) -> Choice:
    """The model of that name, whatever it does. ModelStoreError for a name that no model on this machine has."""
    for task in Task:
        for choice in available(task, cache):
            if choice.name == name:
                return choice
    raise _absent(name, "", cache)


def choose_segmentation(named: str | Path | None, cache: ModelCache, *, simulated: bool) -> Choice | None:
    """The segmentation to use, None for none; ``named`` is a file, a registered name, ``none``, or None.

    The one that ships knows simulated drives only, so a recorded drive gets one only where it is named. Raises
    ModelStoreError as :func:`choose_detector`."""
    if named is not None:
        return None if str(named) == NO_SEGMENTATION else _find(str(named), Task.SEGMENTATION, cache)
    return _shipped(Task.SEGMENTATION, cache) if simulated else None


def choose_boxes(named: str | Path | None, cache: ModelCache, *, simulated: bool) -> Choice | None:
    """The pillar network that makes 3D boxes, None for those that need no weights; ``named`` is a file, a registered
    name, ``clusters``, or None.

    The one that ships knows simulated drives only, where its boxes are the better ones; a recorded drive gets one only
    where it is named. Raises ModelStoreError as :func:`choose_detector`."""
    if named is not None:
        return None if str(named) == WITHOUT_WEIGHTS else _find(str(named), Task.BOXES, cache)
    return _shipped(Task.BOXES, cache) if simulated else None


def _shipped(task: Task, cache: ModelCache) -> Choice | None:
    return next((choice for choice in available(task, cache) if choice.origin is Origin.SHIPPED), None)


def available(task: Task, cache: ModelCache) -> list[Choice]:
    """All models of a task on this machine: official ones, best first, the shipped one, and those that were added."""
    present = {record.name: record for record in cache.records() if record.task is task}
    official = [model.name for model in reversed(OFFICIAL) if model.name in present]
    added = [name for name in present if name not in registered_names()]
    shipped = [Choice(model.name, model.path, Origin.SHIPPED) for model in SHIPPED if model.task is task]
    return [
        *(Choice(name, cache.path(name), Origin.OFFICIAL) for name in official),
        *shipped,
        *(Choice(name, cache.path(name), Origin.ADDED) for name in added),
    ]


def _find(named: str, task: Task, cache: ModelCache) -> Choice:
    for choice in available(task, cache):
        if choice.name == named:
            return choice
    path = Path(named).expanduser()
    if path.suffix == ".onnx" or len(path.parts) > 1 or path.is_file():
        return Choice(path.stem, path.absolute(), Origin.FILE)
    raise _absent(named, f"{task} ", cache)


def _absent(named: str, kind: str, cache: ModelCache) -> ModelStoreError:
    if named in {model.name for model in OFFICIAL}:
        return ModelStoreError(f"{named} is not on this machine yet. Get it: hindsight models pull {named}")
    known = ", ".join(choice.name for task in Task if kind in ("", f"{task} ") for choice in available(task, cache))
    return ModelStoreError(
        f"There is no {kind}model {named}. On this machine there are: {known}. hindsight models list shows all; a file "
        "is named by its path, as in ./model.onnx."
    )
