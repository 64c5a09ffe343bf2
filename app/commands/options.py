"""Options that several commands share."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class IdentityMethod(StrEnum):
    """How tracks are merged."""

    ASSIGNMENT = "assignment"
    BASELINE = "baseline"


class EgoMotionUse(StrEnum):
    """What of the car's own motion boxes are predicted by."""

    FULL = "full"
    ROTATION = "rotation"
    NONE = "none"


class PropagationRule(StrEnum):
    """Whose label all sightings of an object get."""

    HIGHEST = "highest"
    TOP_K = "top-k"


DriveFolder = Annotated[
    Path,
    typer.Argument(
        help="Folder of a recorded drive: an Argoverse 2 sensor log, KITTI tracking, or nuScenes.", show_default=False
    ),
]
ModelName = Annotated[
    str | None,
    typer.Option(
        "--model",
        "-m",
        help="A YOLOX file (.onnx), or a name of `hindsight models list`. (default: HINDSIGHT_MODEL, else the best "
        "official one in the cache, else the one that ships)",
        show_default=False,
    ),
]
SceneName = Annotated[
    str | None,
    typer.Option(
        "--scene", help="Which nuScenes scene or KITTI sequence, where the folder holds several.", show_default=False
    ),
]
WorkspaceFolder = Annotated[
    Path | None,
    typer.Option(
        "--workspace",
        "-w",
        help="Folder for artifacts and the store. (default: HINDSIGHT_WORKSPACE, else hindsight in your data folder)",
        show_default=False,
    ),
]
InputSize = Annotated[
    int | None,
    typer.Option(
        "--input-size",
        help="Longest side in pixels of what the model sees, a multiple of 32: larger finds farther objects, and takes "
        "longer. (default: 960)",
        show_default=False,
    ),
]
TrackerName = Annotated[
    str | None,
    typer.Option(
        "--tracker",
        help="How objects are followed: offline knows the future, two_stage does not, baseline is the paper's own "
        "variant. (default: offline)",
        show_default=False,
    ),
]
EgoMotion = Annotated[
    EgoMotionUse,
    typer.Option(
        "--ego-motion",
        help="What of the car's own motion boxes are predicted by, where poses and calibration are known: its turns "
        "and its way (full), its turns alone (rotation), or nothing (none).",
    ),
]
Identity = Annotated[
    IdentityMethod | None,
    typer.Option(
        "--identity",
        help="How tracks are merged: all evidence at once (assignment), or the paper's Algorithm 2 as it stands "
        "(baseline). (default: HINDSIGHT_IDENTITY, else assignment)",
        show_default=False,
    ),
]
Propagation = Annotated[
    PropagationRule | None,
    typer.Option(
        help="Whose label all sightings of an object get: that of the surest one, as in the paper (highest), or of the "
        "class that wins a vote of the surest (top-k). (default: HINDSIGHT_PROPAGATION, else highest)",
        show_default=False,
    ),
]
TopK = Annotated[
    int | None,
    typer.Option(
        min=1, help="How many sightings vote with top-k. (default: HINDSIGHT_TOP_K, else 5)", show_default=False
    ),
]
DonorWindow = Annotated[
    float | None,
    typer.Option(
        min=0,
        help="Take labels only from sightings less than this many seconds away; 0: from any time. (default: "
        "HINDSIGHT_DONOR_WINDOW_S, else 0)",
        show_default=False,
    ),
]
MinTrust = Annotated[
    float | None,
    typer.Option(
        min=0,
        max=1,
        help="A sighting whose box shows the tracked object with less probability than this keeps the detector's own "
        "label; 0: none. (default: HINDSIGHT_MIN_TRUST, else 0.25 for a small detector, 0.45 for others)",
        show_default=False,
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")]
Port = Annotated[
    int | None,
    typer.Option(
        min=0,
        max=65535,
        help="Port of the page; 0 takes a free one. (default: HINDSIGHT_PORT, else 8000)",
        show_default=False,
    ),
]
OpenBrowser = Annotated[bool, typer.Option("--open/--no-open", help="Open the page in a browser.")]
