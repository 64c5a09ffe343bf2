"""The stages, and how their units of work are keyed, found done, or done.

A :class:`Stage` is a name, a version and a pure function from a unit to the content of a file. The file's key is a hash
of the stage's name and version and of all that the unit depends on, so what is done is found again, and a changed
setting re-runs only what follows from it. Raise the version when the function's result changes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, Protocol, TypeVar

from labeler.pipeline.artifacts import Artifacts
from labeler.pipeline.executors import Executor, SerialExecutor
from labeler.pipeline.types import Progress


class Unit(Protocol):
    """One unit of work."""

    @property
    def key(self) -> str:
        """A hash of all that the result depends on, without the stage."""
        ...

    @property
    def effort(self) -> int:
        """How many frames of heavy work this is."""
        ...


_NOT_WORTH_A_WORKER = 32
"""Frames of heavy work that are done sooner than a worker process starts."""

AnyUnit = TypeVar("AnyUnit", bound=Unit)


@dataclass(frozen=True)
class Stage(Generic[AnyUnit]):
    """One step of the pipeline: ``work`` writes the result of a unit to a path, in any process."""

    name: str
    version: int
    suffix: str
    work: Callable[[AnyUnit, Path], None]

    def path(self, unit: AnyUnit, artifacts: Artifacts) -> Path:
        """Where the unit's artifact lies, or will lie."""
        return artifacts.path(self.name, f"{unit.key}-{self.version}", self.suffix)


@dataclass(frozen=True)
class _Task(Generic[AnyUnit]):
    stage: Stage[AnyUnit]
    unit: AnyUnit
    artifacts: Artifacts


def run_stage(
    stage: Stage[AnyUnit], units: Sequence[AnyUnit], *, artifacts: Artifacts, executor: Executor, progress: Progress
) -> list[Path]:
    """Do what is not done yet; the artifacts of all units, in their order."""
    paths = [stage.path(unit, artifacts) for unit in units]
    tasks = [_Task(stage, unit, artifacts) for unit, path in zip(units, paths, strict=True) if not path.exists()]
    progress.stage(stage.name, len(tasks))
    effort = sum(task.unit.effort for task in tasks)
    here = SerialExecutor() if effort <= _NOT_WORTH_A_WORKER else executor
    for _ in here.run(_do, tasks, count=len(tasks)):
        progress.advance()
    return paths


def _do(task: _Task[AnyUnit]) -> None:
    path = task.stage.path(task.unit, task.artifacts)
    task.artifacts.make(path, lambda temporary: task.stage.work(task.unit, temporary))
