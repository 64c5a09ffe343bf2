"""``hindsight demo``: label a drive and open it for review."""

from typing import Annotated

import typer

from app.commands.label import label_into_store
from app.commands.options import DriveFolder, InputSize, ModelFile, OpenBrowser, Port, SceneName, WorkspaceFolder
from app.commands.serve import serve_page
from app.settings import load_settings
from labeler.pipeline import open_executor


def demo(
    drive: DriveFolder,
    model: ModelFile = None,
    scene: SceneName = None,
    workspace: WorkspaceFolder = None,
    input_size: InputSize = None,
    port: Port = None,
    open_browser: OpenBrowser = True,
    then_serve: Annotated[bool, typer.Option("--serve/--no-serve", help="Open the review page afterwards.")] = True,
) -> None:
    """Label a recorded drive, and open it for review in the browser."""
    settings = load_settings(workspace=workspace, model=model, port=port)
    with open_executor("processes") as executor:
        label_into_store(settings, drive, scene=scene, input_size=input_size, executor=executor)
    if then_serve:
        serve_page(settings, open_browser=open_browser, with_worker=True)
