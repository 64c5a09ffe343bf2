"""``hindsight evaluate``: the stored labels of a drive against its truth."""

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from app.commands.label import label_into_store
from app.commands.options import AsJson, DriveFolder, InputSize, SceneName, WorkspaceFolder
from app.commands.stored_labels import open_stored_labels
from app.commands.terminal import say, show_table
from app.evaluation.schemas import ClassMode
from app.evaluation.service import evaluate_labelling
from app.settings import Settings, load_settings
from labeler.evaluation.report import write_report
from labeler.evaluation.types import IOUS, Evaluation, EvaluationConfig
from labeler.pipeline import open_executor


def evaluate(
    drive: DriveFolder,
    workspace: WorkspaceFolder = None,
    scene: SceneName = None,
    model: Annotated[
        str | None,
        typer.Option("--model", "-m", help="Label with this model first, where that is not done.", show_default=False),
    ] = None,
    input_size: InputSize = None,
    confidence: Annotated[float, typer.Option(min=0, max=1, help="Labels below it are not counted.")] = 0.8,
    max_distance: Annotated[
        float, typer.Option(min=0.1, help="Truth farther away than this, in metres, is neither hit nor miss.")
    ] = 80.0,
    classes: Annotated[
        ClassMode, typer.Option(help="aware: a label of another class is false. agnostic: classes are not compared.")
    ] = ClassMode.AWARE,
    true_identities: Annotated[
        bool,
        typer.Option(
            "--true-identities", help="Count labels as if tracks were merged by the truth: merging's ceiling."
        ),
    ] = False,
    report: Annotated[
        Path | None, typer.Option(help="Write a report with plots to this HTML file.", show_default=False)
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Compare the labels of a drive that comes with truth with that truth."""
    settings = load_settings(workspace=workspace, model=model)
    config = EvaluationConfig(confidence=confidence, max_distance_m=max_distance, classes=classes)
    if model is not None:
        with open_executor("processes") as executor:
            label_into_store(settings, drive, scene=scene, input_size=input_size, executor=executor)
    found = evaluate_drive(settings, drive, scene=scene, config=config, merge_by_truth=true_identities)
    if report is not None:
        write_report(report, found)
        say(f"The report is in {report}.")
    if as_json:
        typer.echo(json.dumps(found))
    else:
        show(found)


def evaluate_drive(
    settings: Settings, folder: Path, *, scene: str | None, config: EvaluationConfig, merge_by_truth: bool = False
) -> Evaluation:
    """Evaluate the labels that the workspace holds of the drive in a folder, or what they would be were its tracks
    merged by the truth. HindsightError where it holds none."""
    with open_stored_labels(settings, folder, scene=scene) as found, found.store.read() as session:
        return evaluate_labelling(
            session,
            settings,
            found.drive,
            found.labelling,
            found.recorded,
            config=config,
            merge_by_truth=merge_by_truth,
        )


def show(evaluation: Evaluation) -> None:
    """The paper's table on standard output: a line for each method, cameras and truth, both IoUs side by side."""
    title = (
        f"{evaluation['drive']}: labels of vehicles with confidence >= {evaluation['confidence']:g}, truth within "
        f"{evaluation['max_distance_m']:g} m ({evaluation['truth_count']:,} boxes)"
    )
    table = Table(title=title, title_justify="left")
    for heading in ("method", "cameras", "truth"):
        table.add_column(heading)
    for iou in IOUS:
        for heading in (f"P@{iou:g}", f"R@{iou:g}", "TP/FP/FN"):
            table.add_column(heading, justify="right")
    lines: dict[tuple[str, str, str], list[str]] = {}
    for row in evaluation["rows"]:
        counts = f"{row['tp']}/{row['fp']}/{row['fn']}"
        cells = [share(row["precision"]), share(row["recall"]), counts]
        lines.setdefault((row["method"], row["cameras"], row["truth"]), []).extend(cells)
    for name, cells in lines.items():
        table.add_row(*name, *cells)
    show_table(table)
    tracking, merges = evaluation["tracking"], evaluation["merges"]
    typer.echo(
        f"identities over all cameras: HOTA {share(tracking['hota'])}, IDF1 {share(tracking['idf1'])}, "
        f"MOTA {share(tracking['mota'])}, {tracking['id_switches']} switches"
    )
    typer.echo(f"merges: {merges['right']} right, {merges['wrong']} wrong, {merges['missed']} missed")


def share(value: float | None) -> str:
    """Three digits, or a dash where there is nothing to be a share of."""
    return "-" if value is None else f"{value:.3f}"
