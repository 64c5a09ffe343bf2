"""``hindsight train``: make the models that ship, from simulated drives, and measure them.

Torch is loaded only where something is trained: it takes seconds, and is not there without the extra `training`."""

import importlib
import importlib.util
import json
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from app.commands.options import AsJson
from app.commands.terminal import TerminalProgress, say, show_table
from app.settings import load_settings
from labeler.models import choose_segmentation
from labeler.training.detector_validation import DetectorReport
from labeler.training.drive_plan import simulate_planned
from labeler.training.errors import TrainingError
from labeler.training.pictures import find_drives
from labeler.training.pillar_validation import PillarReport
from labeler.training.recipes import DETECTOR, PILLARS, SEGMENTATION, UNPAINTED_PILLARS, Device, Recipe
from labeler.training.segmentation_validation import SegmentationReport
from labeler.training.validation import validate_model

train = typer.Typer(
    help="Train the models that ship, on simulated drives. Needs the extra `training`.", no_args_is_help=True
)

RunFolder = Annotated[
    Path,
    typer.Argument(
        metavar="RUN", help="Folder for the checkpoint and the model; a run that was stopped goes on there.",
        show_default=False,
    ),
]  # fmt: skip
Drives = Annotated[
    list[Path],
    typer.Option(
        "--drives", "-d", help="A drive, or a folder of drives; may be given several times.", show_default=False
    ),
]
Steps = Annotated[int, typer.Option(min=1, help="Steps in all.")]
Seed = Annotated[int, typer.Option(min=0, help="The first weights and all examples follow from it.")]
BatchSize = Annotated[int, typer.Option(min=1, help="Examples in a step.")]
Workers = Annotated[
    int | None,
    typer.Option(
        min=1,
        help="Cores to use; they share the examples of a step. (default: 2, for segmentation 1; beside a GPU what the "
        "cores allow)",
        show_default=False,
    ),
]
OnDevice = Annotated[Device, typer.Option("--device", help="What computes the gradients: cores, or an NVIDIA GPU.")]
FIRST_SEED, EXAMPLES_A_STEP = 1, 8


@train.command()
def drives(
    out: Annotated[
        Path, typer.Argument(help="Folder of the drives; those that are there are left alone.", show_default=False)
    ],
    training: Annotated[int, typer.Option(min=0, help="How many drives to learn from.")] = 40,
    validation: Annotated[int, typer.Option(min=0, help="How many drives of other seeds, to validate with.")] = 8,
) -> None:
    """Simulate drives to learn from, and others to validate with. Needs the extra `simulation`."""
    with TerminalProgress() as progress:
        simulate_planned(out, training=training, validation=validation, progress=progress)
    say(f"{out / 'training'}: {training} drives to learn from; {out / 'validation'}: {validation} to validate with.")


def _command_for(recipe: Recipe, name: str, about: str) -> None:
    """A command that follows a recipe; its options begin with what the recipe says."""

    def follow(
        run: RunFolder,
        drives: Drives,
        steps: Steps = recipe.steps,
        seed: Seed = FIRST_SEED,
        batch_size: BatchSize = EXAMPLES_A_STEP,
        workers: Workers = None,
        device: OnDevice = Device.CPU,
    ) -> None:
        _require_torch()
        runs = importlib.import_module("labeler.training.runs")
        file: Path = runs.train_recipe(
            recipe, run, drives, steps=steps, seed=seed, batch_size=batch_size, workers=workers, device=device,
            report=say,
        )  # fmt: skip
        _say_written(file)

    train.command(name, help=about)(follow)


_command_for(DETECTOR, "detector", "Train a YOLOX-nano detector of vehicles, and write it into RUN.")
_command_for(
    SEGMENTATION,
    "segmentation",
    "Train a network that tells road, building, vegetation and vehicle, and write it into RUN.",
)


@train.command()
def pillars(
    run: RunFolder,
    drives: Drives,
    steps: Steps = PILLARS.steps,
    seed: Seed = FIRST_SEED,
    batch_size: BatchSize = EXAMPLES_A_STEP,
    workers: Workers = None,
    device: OnDevice = Device.CPU,
    painter: Annotated[
        str, typer.Option(help="The segmentation that paints the points: a name, or an .onnx file.")
    ] = "sim-segmentation",
    clouds: Annotated[
        Path | None,
        typer.Option(help="Folder to keep painted clouds in. (default: clouds, beside RUN)", show_default=False),
    ] = None,
    unpainted: Annotated[
        bool, typer.Option("--unpainted", help="Leave out what the images say, to see what painting is worth.")
    ] = False,
) -> None:
    """Train a network that finds vehicles in 3D, in LiDAR points painted by a segmentation, and write it into RUN."""
    chosen = choose_segmentation(painter, load_settings().model_cache, simulated=True)
    if chosen is None:
        raise TrainingError("Points need a segmentation that paints them: --painter sim-segmentation, or a file.")
    _require_torch()
    runs = importlib.import_module("labeler.training.runs")
    file: Path = runs.train_pillars(
        UNPAINTED_PILLARS if unpainted else PILLARS, run, drives, painter=chosen.path,
        clouds=clouds or run.absolute().parent / "clouds", steps=steps, seed=seed, batch_size=batch_size,
        workers=workers, device=device, report=say,
    )  # fmt: skip
    _say_written(file)


@train.command()
def validate(
    model: Annotated[Path, typer.Argument(help="A model that was trained so (.onnx).", show_default=False)],
    drives: Drives,
    as_json: AsJson = False,
) -> None:
    """Measure a trained model on drives that it has not seen."""
    found = find_drives(drives)
    with TerminalProgress() as progress:
        progress.stage("Running the model", len(found))
        report = validate_model(model, found, progress.advance)
    if as_json:
        typer.echo(json.dumps(report.as_json()))
    else:
        say(f"{report.model}: {_amount(report)} on one core; {', '.join(report.drives)}")
        show_table(_table(report))


def _require_torch() -> None:
    if importlib.util.find_spec("torch") is None:
        raise TrainingError("Training needs torch. Install it: pip install 'hindsight-labeler[training]'")


def _say_written(file: Path) -> None:
    say(f"{file} is written. Measure it: hindsight train validate {file} --drives FOLDER")


def _amount(report: DetectorReport | SegmentationReport | PillarReport) -> str:
    if isinstance(report, PillarReport):
        return f"{report.directions} camera directions, {report.cpu_ms_per_direction:.1f} ms of CPU each"
    return f"{report.images} images, {report.cpu_ms_per_image:.1f} ms of CPU each"


def _table(report: DetectorReport | SegmentationReport | PillarReport) -> Table:
    if isinstance(report, PillarReport):
        return _pillar_table(report)
    if isinstance(report, SegmentationReport):
        table = Table("class", "IoU", "share of pixels")
        for result in report.results:
            table.add_row(result.name, _figure(result.iou), f"{result.truth_share:.3f}")
        return table
    table = Table("vehicles", "count", "AP@.5", "any class", "P at .8", "R at .8")
    for scope in report.results:
        figures = (
            scope.average_precision,
            scope.average_precision_any_class,
            scope.precision_at_confidence,
            scope.recall_at_confidence,
        )
        table.add_row(scope.name, str(scope.truth_count), *(_figure(figure) for figure in figures))
    return table


def _pillar_table(report: PillarReport) -> Table:
    table = Table("vehicles", "count", "AP@.5 from above", "right class", "off", "within 1 std")
    for scope in report.results:
        off = "-" if scope.median_off_m is None else f"{scope.median_off_m:.2f} m"
        shares = (scope.average_precision, scope.right_class, scope.within_deviation)
        precision, right_class, within = (_figure(share) for share in shares)
        table.add_row(scope.name, str(scope.truth_count), precision, right_class, off, within)
    return table


def _figure(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"
