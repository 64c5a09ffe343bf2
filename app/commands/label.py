"""``hindsight label``: label a drive, and put the result where ``hindsight serve`` shows it."""

import json
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from app.commands.options import (
    AsJson,
    DonorWindow,
    DriveFolder,
    EgoMotion,
    EgoMotionUse,
    Identity,
    InputSize,
    MinTrust,
    ModelName,
    Propagation,
    SceneName,
    TopK,
    TrackerName,
    WorkspaceFolder,
)
from app.commands.stored_labels import decisions_about
from app.commands.terminal import TerminalProgress, say
from app.db.engine import migrate, open_engine
from app.db.session import Store
from app.drives import service as drives_service
from app.drives.schemas import DriveRegistration
from app.model_choice import boxes_file, chosen_detector, segmentation_file
from app.settings import Settings, load_settings
from app.tracks.importing import import_labelled_drive
from labeler.detection import DetectionConfig
from labeler.drive import Drive, is_simulated, open_drive
from labeler.errors import HindsightError
from labeler.evaluation.merges import score_merges
from labeler.identity import IdentityConfig
from labeler.pipeline import Executor, LabelledDrive, LabelSettings, Progress, Summary, label_drive, open_executor
from labeler.tracking import TrackingConfig


class ExecutorName(StrEnum):
    """Who does the work."""

    PROCESSES = "processes"
    SERIAL = "serial"


def label(
    drive: DriveFolder,
    model: ModelName = None,
    scene: SceneName = None,
    workspace: WorkspaceFolder = None,
    input_size: InputSize = None,
    tracker: TrackerName = None,
    ego_motion: EgoMotion = EgoMotionUse.FULL,
    identity: Identity = None,
    propagation: Propagation = None,
    top_k: TopK = None,
    donor_window: DonorWindow = None,
    min_trust: MinTrust = None,
    executor: Annotated[
        ExecutorName, typer.Option(help="Worker processes on all cores, or one thing after the other in one process.")
    ] = ExecutorName.PROCESSES,
    workers: Annotated[
        int | None, typer.Option(min=1, help="How many cores to use. (default: all)", show_default=False)
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Label a recorded drive. Stop it with Ctrl-C at any time; the same command goes on from there."""
    settings = load_settings(
        workspace=workspace,
        model=model,
        identity=identity,
        propagation=propagation,
        top_k=top_k,
        donor_window_s=donor_window,
        min_trust=min_trust,
    )
    with open_executor(executor.value, workers=workers) as open_workers:
        summary = label_into_store(
            settings,
            drive,
            scene=scene,
            input_size=input_size,
            tracking=tracking_config(tracker, ego_motion.value),
            executor=open_workers,
        )
    if as_json:
        typer.echo(json.dumps(summary))


def label_into_store(
    settings: Settings,
    folder: Path,
    *,
    scene: str | None,
    input_size: int | None,
    tracking: TrackingConfig | None = None,
    executor: Executor,
) -> Summary:
    """Label the drive in a folder, take the result into the store, and say on standard error what came out."""
    recorded = open_drive(folder.absolute(), scene=scene)
    say(f"{recorded.name}: {len(recorded.frames)} frames, {len(recorded.cameras)} cameras ({recorded.format})")
    detector = chosen_detector(settings)
    segmentation = segmentation_file(settings, recorded.root)
    say(f"  model {detector.name}: {detector.path}")
    notice = detector.notice(simulated=is_simulated(recorded.root))
    if notice is not None:
        say(f"Note: {notice}")
    with TerminalProgress() as progress:
        labelled = label_drive(
            recorded,
            model=detector.path,
            segmentation=segmentation,
            boxes=boxes_file(settings, recorded.root),
            workspace=settings.workspace,
            settings=label_settings(settings, detector.path, input_size, tracking),
            decisions=decisions_about(settings, recorded, scene=scene),
            executor=executor,
            progress=progress,
        )
        store_labels(settings, folder, labelled, scene=scene, model_name=detector.name, progress=progress)
    _report(labelled.summary)
    _report_truth(recorded, labelled)
    return labelled.summary


def store_labels(
    settings: Settings,
    folder: Path,
    labelled: LabelledDrive,
    *,
    scene: str | None,
    model_name: str,
    progress: Progress,
) -> None:
    """Register the drive in a folder where it is not yet, and make ``labelled`` its current labels in the store."""
    engine = open_engine(settings.store_url)
    migrate(engine)
    store = Store(engine)
    stored = drives_service.add_local_drive(store, DriveRegistration(path=str(folder.absolute()), scene=scene))
    import_labelled_drive(store, stored.id, labelled, model_name=model_name, progress=progress)
    engine.dispose()


def tracking_config(tracker: str | None, ego_motion: str) -> TrackingConfig:
    """How to track. TrackingError when there is no such tracker."""
    config = TrackingConfig(ego_motion=ego_motion)
    return config if tracker is None else replace(config, method=tracker)


def label_settings(
    settings: Settings, detector: Path, input_size: int | None, tracking: TrackingConfig | None = None
) -> LabelSettings:
    """The labeler's settings as the user wants them, with the input size and how to track where they are given.

    HindsightError when the input size is out of range."""
    chosen = LabelSettings(
        tracking=tracking or TrackingConfig(),
        identity=IdentityConfig(method=settings.identity),
        propagation=settings.propagation_config(detector),
    )
    if input_size is None:
        return chosen
    try:
        return replace(chosen, detection=DetectionConfig(input_long_side_px=input_size))
    except ValueError as error:
        raise HindsightError(f"--input-size {input_size} can't be used: {error}.") from error


def _report(summary: Summary) -> None:
    for warning in summary["warnings"]:
        say(f"Warning: {warning}")
    for name, camera in summary["cameras"].items():
        say(f"  {name}: {camera['frames']} images, {camera['detections']} detections, {camera['tracks']} tracks")
    merges = summary["merges"]
    say(
        f"  {summary['identities']} identities; merges: {merges['accepted']} accepted, {merges['proposed']} proposed, "
        f"{merges['rejected']} rejected; {summary['labels_propagated']} labels propagated"
    )
    say(f"  {sum(summary['seconds'].values()):.1f} s, {summary['peak_memory_mb']:.0f} MB at the peak")


def _report_truth(drive: Drive, labelled: LabelledDrive) -> None:
    """Where the drive comes with true boxes, say how many merges agree with them."""
    truth = drive.read_truth(drive.frames)
    if truth is not None and truth.boxes_2d is not None:
        observations = {camera.name: labelled.observations(camera.name) for camera in drive.cameras}
        say(f"  {score_merges(truth.boxes_2d, observations, labelled.identity_of).sentence()}")
