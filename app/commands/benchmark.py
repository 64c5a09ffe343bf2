"""``hindsight benchmark``: measure on this machine."""

import json
import tempfile
import time
from collections.abc import Mapping
from dataclasses import asdict, replace
from itertools import chain
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from app.commands.evaluate import evaluate_drive, share
from app.commands.label import label_settings, store_labels
from app.commands.options import AsJson, DriveFolder, InputSize, ModelName, SceneName, WorkspaceFolder
from app.commands.terminal import TerminalProgress, say, show_table
from app.model_choice import chosen_detector, segmentation_file
from app.settings import Settings, load_settings
from labeler.detection import DetectionConfig, open_detector
from labeler.drive import open_drive, open_truth
from labeler.errors import HindsightError
from labeler.evaluation.benchmark_merges import MergeBenchmark, benchmark_merges
from labeler.evaluation.boxes_3d import BoxReport
from labeler.evaluation.boxes_3d_cases import Seen, find_boxes, judge_makers
from labeler.evaluation.drive_sequences import sequences_of_drive
from labeler.evaluation.label_benchmark import benchmark_labels
from labeler.evaluation.made_observations import Noise, scene_of
from labeler.evaluation.made_up import MadeUp, made_up_labels, write_made_up_drive
from labeler.evaluation.text_sequences import read_sequences
from labeler.evaluation.tracker_benchmark import OBJECTS, TrackerTimes, benchmark_trackers
from labeler.evaluation.types import EvaluationConfig
from labeler.lidar import LidarConfig
from labeler.models import WITHOUT_WEIGHTS, Origin, Task, available, choose_boxes
from labeler.pipeline import SilentProgress
from labeler.pipeline.benchmark import benchmark_pipeline, repeat_frames
from labeler.segmentation import open_segmenter

benchmark = typer.Typer(help="Measure on this machine.", no_args_is_help=True)


@benchmark.callback()
def measure() -> None:
    """Measure on this machine."""


@benchmark.command()
def pipeline(
    drive: DriveFolder,
    model: ModelName = None,
    scene: SceneName = None,
    input_size: InputSize = None,
    repeat: Annotated[int, typer.Option(min=1, help="Run over the drive's frames this many times in a row.")] = 1,
    runs: Annotated[int, typer.Option(min=1, help="Take the median of this many runs.")] = 3,
    as_json: AsJson = False,
) -> None:
    """Time the whole pipeline beside the bare loop: decode each image and run the model on it."""
    settings = load_settings(model=model)
    recorded = repeat_frames(open_drive(drive, scene=scene), repeat)
    model_file = chosen_detector(settings).path
    times = benchmark_pipeline(
        recorded, model=model_file, settings=label_settings(settings, model_file, input_size), runs=runs
    )
    if as_json:
        typer.echo(json.dumps(times))
        return
    say(f"{times['frames']} frames, median of {runs} runs")
    say(f"bare loop  {times['bare_seconds']:8.2f} s   decode each image, run the model on it")
    say(f"pipeline   {times['pipeline_seconds']:8.2f} s   of which LiDAR {times['lidar_seconds']:.2f} s")
    say(f"ratio      {times['ratio']:8.2f}     (pipeline - LiDAR) / bare loop")
    say(f"memory     {times['peak_memory_mb']:8.0f} MB  at the peak, workers included")


@benchmark.command()
def boxes(
    drive: DriveFolder,
    model: Annotated[
        str | None,
        typer.Option("--model", "-m", help="Box what this model detects, not the true 2D boxes.", show_default=False),
    ] = None,
    makers: Annotated[
        list[str] | None,
        typer.Option(
            "--boxes", "-b",
            help="What makes the boxes: clusters, or a pillar network by name or file; may be given several times. "
            "(default: clusters, and the network that ships)",
            show_default=False,
        ),
    ] = None,
    scene: SceneName = None,
    input_size: InputSize = None,
    as_json: AsJson = False,
) -> None:  # fmt: skip
    """Compare the 3D boxes of each camera direction with a drive's 3D truth, and time the LiDAR step."""
    settings = load_settings()
    chosen = label_settings(settings, chosen_detector(settings).path, input_size)
    recorded = open_drive(drive, scene=scene)
    detector = (
        None if model is None else open_detector(chosen_detector(load_settings(model=model)).path, chosen.detection)
    )
    segmentation = segmentation_file(settings, recorded.root)
    segmenter = None if segmentation is None else open_segmenter(segmentation)
    configs = {name: _maker(name, settings, chosen.lidar) for name in makers or _default_makers(settings)}
    with TerminalProgress() as progress:
        progress.stage("Boxing in 3D", len(recorded.frames))
        reports = judge_makers(
            recorded,
            {name: find_boxes(recorded, config, detector) for name, config in configs.items()},
            Seen.by(recorded, detector, segmenter),
            progress=progress.advance,
        )
    if as_json:
        typer.echo(json.dumps({"makers": [{"maker": name, **asdict(report)} for name, report in reports.items()]}))
        return
    for name, report in reports.items():
        _print_boxes(name, report)
    if len(reports) > 1:
        _print_makers(reports)


def _maker(named: str, settings: Settings, config: LidarConfig) -> LidarConfig:
    """The LiDAR step with that maker. ModelStoreError for a name that no pillar network has."""
    network = choose_boxes(named, settings.model_cache, simulated=False)
    return config if network is None else replace(config, method="pillars", network=str(network.path))


def _default_makers(settings: Settings) -> list[str]:
    """The boxes that need no weights, and the networks that ship."""
    networks = available(Task.BOXES, settings.model_cache)
    return [WITHOUT_WEIGHTS, *(choice.name for choice in networks if choice.origin is Origin.SHIPPED)]


def _print_makers(reports: Mapping[str, BoxReport]) -> None:
    table = Table(title="vehicles with at least 20 points, within 40 m; AP@.5 within 50 m", title_justify="left")
    for heading in ("maker", "cases", "boxed", "off", "p90", "IoU>=.5", "AP@.5", "ms a frame"):
        table.add_column(heading, justify="left" if heading == "maker" else "right")
    for name, report in reports.items():
        score = report.overall
        off = (_metres(score.median_error_m), _metres(score.p90_error_m))
        found = (share(score.good), share(report.average_precision), f"{report.cpu_ms_per_frame:.0f}")
        table.add_row(name, str(score.cases), share(score.boxed), *off, *found)
    show_table(table)


def _print_boxes(name: str, report: BoxReport) -> None:
    typer.echo(f"3D boxes by {name}")
    typer.echo(f"{'true objects in images':34}{'cases':>6}{'boxed':>7}{'off':>9}{'p90':>9}{'yaw':>8}{'IoU>=.5':>9}")
    for score in (report.overall, *report.groups):
        typer.echo(
            f"{score.group:34}{score.cases:6}{share(score.boxed):>7}{_metres(score.median_error_m):>9}"
            f"{_metres(score.p90_error_m):>9}{_degrees(score.median_yaw_off_deg):>8}{share(score.good):>9}"
        )
    agreement = report.agreement
    typer.echo(
        f"{agreement.pairs} times two cameras box one object: median {_metres(agreement.median_apart_m)} apart, "
        f"{share(agreement.near)} within half a metre"
    )
    typer.echo(f"bird's-eye AP@.5 within 50 m {share(report.average_precision)}")
    typer.echo(f"{report.cpu_ms_per_frame:.0f} ms of processor time a frame, over {report.frames} frames")


def _metres(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f} m"


def _degrees(value: float | None) -> str:
    return "-" if value is None else f"{value:.1f}°"


@benchmark.command()
def evaluate(
    frames: Annotated[int, typer.Option(min=1, help="Frames of the drive.")] = 1000,
    cameras: Annotated[int, typer.Option(min=1, help="Cameras of the drive.")] = 4,
    objects: Annotated[int, typer.Option(min=1, help="Objects, and labels, in each image.")] = 15,
    as_json: AsJson = False,
) -> None:
    """Time `hindsight evaluate` on the stored labels of a made-up drive."""
    size = MadeUp(frames=frames, cameras=cameras, objects=objects)
    with tempfile.TemporaryDirectory(prefix="hindsight-benchmark-") as folder:
        store_url = f"sqlite:///{folder}/hindsight.db"
        settings = load_settings(workspace=Path(folder), database_url=store_url)
        drive = write_made_up_drive(Path(folder) / "drive", size)
        store_labels(settings, drive, made_up_labels(size), scene=None, model_name="made up", progress=SilentProgress())
        start = time.perf_counter()
        found = evaluate_drive(settings, drive, scene=None, config=EvaluationConfig())
        seconds = round(time.perf_counter() - start, 3)
    if as_json:
        typer.echo(json.dumps({"frames": frames, "cameras": cameras, "objects": objects, "evaluate_seconds": seconds}))
        return
    images = frames * cameras
    say(f"{seconds:.2f} s to evaluate {images} images with {objects} labels each ({found['truth_count']} true boxes)")


@benchmark.command()
def labels(
    root: Annotated[
        Path | None,
        typer.Option(help="Folder with label_02, calib and det_* of KITTI tracking sequences.", show_default=False),
    ] = None,
    drives: Annotated[
        list[Path] | None,
        typer.Option(
            "--drive",
            help="Instead: a drive with true boxes in its images, which a model sees; may be given several times. Adds "
            "rows with less of the car's own motion.",
            show_default=False,
        ),
    ] = None,
    model: ModelName = None,
    cameras: Annotated[
        list[str] | None,
        typer.Option(
            "--camera", help="Of drives, this camera; may be given several times. (default: all)", show_default=False
        ),
    ] = None,
    every: Annotated[int, typer.Option(min=1, help="Of drives, every so-manieth frame.")] = 1,
    workspace: WorkspaceFolder = None,
    detections: Annotated[
        str | None, typer.Option(help="Name of the folder of detections. (default: the only one)", show_default=False)
    ] = None,
    passes: Annotated[bool, typer.Option("--passes", help="Add a row for each pass, to show what it adds.")] = False,
    as_json: AsJson = False,
) -> None:
    """Compare labels without tracking, by the paper's method and by ours, on recorded detections or drives with
    truth."""
    if (root is None) == (not drives):
        raise HindsightError("Name a folder of recorded detections (--root), or one or more drives (--drive).")
    config = EvaluationConfig()
    with TerminalProgress() as progress:
        if root is not None:
            sequences = read_sequences(root, detections=detections, config=config)
        else:
            settings = load_settings(model=model, workspace=workspace)
            sequences = chain.from_iterable(
                sequences_of_drive(
                    open_drive(folder),
                    model=chosen_detector(settings).path,
                    workspace=settings.workspace,
                    detection=DetectionConfig(),
                    config=config,
                    progress=progress,
                    cameras=cameras or (),
                    every=every,
                )
                for folder in drives or ()
            )
        rows = benchmark_labels(sequences, passes=passes, ego_motions=root is None, config=config)
    if as_json:
        typer.echo(json.dumps({"rows": rows}))
        return
    titles = ("P@.25", "R@.25", "R>40m", "P@.5", "R@.5", "HOTA", "MOTA", "IDF1", "IDs/object")
    say(f"{'labels':22} " + " ".join(f"{title:>6}" for title in titles))
    for row in rows:
        shares = (row["p25"], row["r25"], row["r25_far"], row["p50"], row["r50"], row["hota"], row["mota"], row["idf1"])
        figures = (*shares, row["identities_per_object"])
        say(f"{row['method']:22} " + " ".join(f"{'-':>6}" if one is None else f"{one:6.3f}" for one in figures))


@benchmark.command()
def trackers(
    frames: Annotated[int, typer.Option(min=20, help="Frames to track.")] = 500,
    runs: Annotated[int, typer.Option(min=1, help="Take the median of this many runs of each tracker.")] = 3,
    seed: Annotated[int, typer.Option(min=0, help="The detections follow from it.")] = 0,
    as_json: AsJson = False,
) -> None:
    """Time our trackers beside those of other packages on made detections: neither images nor a model are read."""
    with TerminalProgress() as progress:
        progress.stage("Tracking", runs * len(OBJECTS))
        found = benchmark_trackers(frames=frames, runs=runs, seed=seed, progress=progress.advance)
    if as_json:
        typer.echo(json.dumps(found))
        return
    _show_trackers(found)


def _show_trackers(found: TrackerTimes) -> None:
    """A line for each tracker on standard output, those that could not take part on standard error."""
    table = Table(title=f"frames per second of processor time, median of {found['runs']} runs", title_justify="left")
    table.add_column("tracker")
    for objects in OBJECTS:
        table.add_column(f"{objects} objects", justify="right")
    speed = {(row["tracker"], row["objects"]): row["frames_per_cpu_second"] for row in found["rows"]}
    for name in dict.fromkeys(row["tracker"] for row in found["rows"]):
        version = found["versions"].get(name)
        title = name if version is None else f"{name} {version}"
        table.add_row(title, *(f"{speed[name, objects]:.0f}" for objects in OBJECTS))
    show_table(table)
    for skipped in found["skipped"]:
        say(f"Skipped {skipped['tracker']}: {skipped['reason']}")


@benchmark.command()
def merges(
    drive: DriveFolder,
    scene: SceneName = None,
    noise: Annotated[
        float, typer.Option(min=0, max=5, help="How strong the noise is: 0 is exact, 1 usual, 2 twice the errors.")
    ] = 1.0,
    seed: Annotated[int, typer.Option(min=0, help="The noise follows from it.")] = 0,
    lidar: Annotated[bool, typer.Option("--lidar/--no-lidar", help="Make 3D boxes as from LiDAR, or none.")] = True,
    frames: Annotated[
        int | None, typer.Option(min=1, help="Use the first frames only. (default: all)", show_default=False)
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Measure merging against a drive's true 3D boxes, with made observations: neither images nor sweeps are read."""
    seen = scene_of(open_truth(drive, scene=scene), max_frames=frames)
    found = benchmark_merges(seen, Noise(noise, seed, lidar=lidar))
    if as_json:
        typer.echo(json.dumps(found))
    else:
        _show_merges(found)


def _show_merges(found: MergeBenchmark) -> None:
    """A line for each method on standard output."""
    tracks = f"{found['tracks']} tracks of {found['objects']} vehicles in {found['cameras']} cameras"
    title = f"{found['drive']}: {tracks}, {found['frames']} frames; noise {found['noise']:g}, seed {found['seed']}"
    table = Table(title=title, title_justify="left")
    headings = ("method", "pairs right/wrong/missed", "precision", "recall", "pure", "whole", "IDF1", "at one time")
    for heading in headings:
        table.add_column(heading, justify="left" if heading == "method" else "right")
    for row in found["rows"]:
        table.add_row(
            row["method"],
            f"{row['pairs_right']}/{row['pairs_wrong']}/{row['pairs_missed']}",
            share(row["pair_precision"]),
            share(row["pair_recall"]),
            share(row["identities_pure"]),
            share(row["identities_whole"]),
            share(row["idf1"]),
            f"{share(row['overlapping_precision'])} / {share(row['overlapping_recall'])}",
        )
    show_table(table)
