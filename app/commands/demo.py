"""``hindsight demo``: label a drive, count the labels against its truth, and open it for review."""

from pathlib import Path
from typing import Annotated

import typer

from app.commands.evaluate import evaluate_drive, show
from app.commands.label import label_into_store
from app.commands.options import InputSize, ModelName, OpenBrowser, Port, SceneName, WorkspaceFolder
from app.commands.serve import serve_page
from app.settings import load_settings
from labeler.drive import open_drive
from labeler.evaluation.types import EvaluationConfig
from labeler.pipeline import open_executor
from labeler.simulation.sample import sample_drive


def demo(
    drive: Annotated[
        Path | None,
        typer.Argument(
            help="Folder of a recorded drive; without it, the simulated drive that ships with Hindsight.",
            show_default=False,
        ),
    ] = None,
    model: ModelName = None,
    scene: SceneName = None,
    workspace: WorkspaceFolder = None,
    input_size: InputSize = None,
    port: Port = None,
    open_browser: OpenBrowser = True,
    then_serve: Annotated[bool, typer.Option("--serve/--no-serve", help="Open the review page afterwards.")] = True,
) -> None:
    """Label a drive, print how right the labels are where it has truth, and open it for review in the browser."""
    settings = load_settings(workspace=workspace, model=model, port=port)
    folder = drive or sample_drive()
    with open_executor("processes") as executor:
        label_into_store(settings, folder, scene=scene, input_size=input_size, executor=executor)
    if _has_true_boxes(folder, scene):
        show(evaluate_drive(settings, folder, scene=scene, config=EvaluationConfig()))
    if then_serve:
        serve_page(settings, open_browser=open_browser, with_worker=True)


def _has_true_boxes(folder: Path, scene: str | None) -> bool:
    recorded = open_drive(folder, scene=scene)
    truth = recorded.read_truth(recorded.frames)
    return truth is not None and truth.boxes_2d is not None
