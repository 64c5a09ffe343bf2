"""What the commands say on the terminal: all of it on standard error, so that standard output holds only results."""

from __future__ import annotations

from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TaskID, TextColumn, TimeElapsedColumn
from rich.table import Table

INTERRUPTED = 130
WIDEST_TABLE = 200
STAGES = {
    "detect": "Detecting in each image",
    "segment": "Segmenting each image",
    "lidar": "Fitting 3D boxes to LiDAR points",
    "track": "Tracking in each camera",
    "colours": "Looking at the colours of tracks",
    "identity": "Finding tracks of one object",
    "donors": "Choosing the best observations",
    "labels": "Propagating their labels",
    "store": "Storing for review",
}


def say(text: str) -> None:
    """A line for the person at the terminal."""
    Console(stderr=True, highlight=False, soft_wrap=True).print(text, markup=False)


def show_table(table: Table) -> None:
    """A result in rows, on standard output; as wide as it needs, since a number must not be cut."""
    console = Console(highlight=False)
    needed = console.measure(table, options=console.options.update(width=WIDEST_TABLE)).maximum
    console.width = max(console.width, needed)
    console.print(table, markup=False)


class TerminalProgress:
    """A bar for each stage of a run that has work to do."""

    def __init__(self) -> None:
        self._bars = Progress(
            SpinnerColumn(finished_text="[green]✓"),
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            console=Console(stderr=True),
        )
        self._current: TaskID | None = None

    def stage(self, name: str, units: int) -> None:
        self._current = None
        if units:
            self._current = self._bars.add_task(STAGES.get(name, name), total=units)

    def advance(self, units: int = 1) -> None:
        if self._current is not None:
            self._bars.advance(self._current, units)

    def __enter__(self) -> TerminalProgress:
        self._bars.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bars.stop()
