"""``hindsight audit``: how far the labels of a drive can be believed, without truth."""

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from app.audit.service import audit_labelling
from app.commands.options import AsJson, DriveFolder, SceneName, WorkspaceFolder
from app.commands.stored_labels import open_stored_labels
from app.commands.terminal import TerminalProgress, say, show_table
from app.settings import Settings, load_settings
from labeler.evaluation.audit import FEW_HIDDEN, Agreement, Audit, AuditConfig, AuditRow


def audit(
    drive: DriveFolder,
    workspace: WorkspaceFolder = None,
    scene: SceneName = None,
    share: Annotated[
        float | None,
        typer.Option(
            help="Which share of the confident observations to hide. (default: 0.05, of short drives up to 0.2)",
            show_default=False,
        ),
    ] = None,
    confidence: Annotated[
        float, typer.Option(min=0, max=1, help="Observations with at least this score are confident.")
    ] = 0.8,
    seed: Annotated[int, typer.Option(min=0, help="Who is hidden follows from it.")] = 0,
    as_json: AsJson = False,
) -> None:
    """Hide some confident observations of a labelled drive, and say how often labels and boxes come back."""
    settings = load_settings(workspace=workspace)
    config = AuditConfig(share=share, confidence=confidence, seed=seed)
    found = audit_drive(settings, drive, scene=scene, config=config)
    if found["hidden"] < FEW_HIDDEN:
        say(
            f"Warning: only {found['hidden']} observations were hidden, so go by the intervals, not by the shares. To "
            "know more, hide a larger share, or ask for less confidence."
        )
    if as_json:
        typer.echo(json.dumps(found))
    else:
        show(found)


def audit_drive(settings: Settings, folder: Path, *, scene: str | None, config: AuditConfig) -> Audit:
    """Audit the labels that the workspace holds of the drive in a folder. HindsightError where it holds none."""
    with open_stored_labels(settings, folder, scene=scene) as found, TerminalProgress() as progress:
        return audit_labelling(
            found.store, settings, found.drive, found.labelling, found.recorded, config=config, progress=progress
        )


def show(found: Audit) -> None:
    """The audit on standard output: all, then by distance, then by height."""
    title = (
        f"{found['drive']}: {found['hidden']} of {found['confident']:,} observations with confidence >= "
        f"{found['confidence']:g} hidden (seed {found['seed']})"
    )
    table = Table(title=title, title_justify="left")
    table.add_column("of those")
    for heading in ("hidden", "box found", "95 %", "class right", "95 %"):
        table.add_column(heading, justify="right")
    table.add_row("all", *_cells(found["box"], found["label"]))
    for rows, unit in ((found["by_distance"], "m"), (found["by_height"], "px high")):
        for row in rows:
            table.add_row(_range(row, unit), *_cells(row["box"], row["label"]))
    show_table(table)
    typer.echo("Class right: of the boxes that were found. The hidden ones are those that the detector was sure of.")


def _cells(box: Agreement, label: Agreement) -> tuple[str, ...]:
    return (f"{box['of']:,}", _share(box["share"]), _interval(box), _share(label["share"]), _interval(label))


def _range(row: AuditRow, unit: str) -> str:
    stop = row["stop"]
    return f"from {row['start']:g} {unit}" if stop is None else f"{row['start']:g} to {stop:g} {unit}"


def _share(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"


def _interval(found: Agreement) -> str:
    return "-" if found["low"] is None else f"{found['low']:.2f} to {found['high']:.2f}"
