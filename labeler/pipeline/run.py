"""The whole run: a drive and a model in, labels out.

The units of every stage are planned from what the stages before gave, each with a key of all that it depends on; then
those that are not done yet are done. See :mod:`labeler.pipeline.plan` for the keys.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Generator, Iterable, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from labeler.detection import open_detector
from labeler.drive import Drive
from labeler.identity import Decisions, IdentityConfig, Merges, MergeState
from labeler.identity.config import BASELINE
from labeler.lidar import LidarConfig, calibration_warnings, takes_paint
from labeler.pipeline import plan
from labeler.pipeline.artifacts import Artifacts, key_of
from labeler.pipeline.colouring import COLOURS, read_colours
from labeler.pipeline.detecting import detect
from labeler.pipeline.executors import Executor, open_executor
from labeler.pipeline.lidar_units import LIDAR, agreement_of
from labeler.pipeline.memory import PeakMemory
from labeler.pipeline.reading import read_labelled_frames
from labeler.pipeline.results import ResultFiles, keep_detections, keep_files
from labeler.pipeline.segmenting import segment
from labeler.pipeline.settings import LabelSettings
from labeler.pipeline.stages import AnyUnit, Stage, run_stage
from labeler.pipeline.tables import read_batches, read_note
from labeler.pipeline.types import (
    CameraSummary,
    LabelledDrive,
    MergeSummary,
    Progress,
    SilentProgress,
    Summary,
    TrackSummary,
)
from labeler.pipeline.units import DONORS, IDENTITY, LABELS, TRACK, read_donors, read_identities
from labeler.segmentation import open_segmenter


def label_drive(
    drive: Drive,
    *,
    model: Path,
    segmentation: Path | None = None,
    boxes: Path | None = None,
    workspace: Path,
    settings: LabelSettings | None = None,
    decisions: Decisions | None = None,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> LabelledDrive:
    """Label ``drive`` with the YOLOX model in the file ``model``, keeping artifacts in the folder ``workspace``.

    With a ``segmentation`` model, images of calibrated cameras are segmented for the painting of LiDAR points; a drive
    without LiDAR or calibration does without. ``boxes`` is a pillar network for 3D boxes; they are made without weights
    where it is None, or takes painted points and nothing paints them.
    What an earlier run in the same workspace made of the same data, model and settings is taken from there, so a run
    that was stopped resumes. ``decisions`` of a person about an earlier run hold in this one as well. ``executor``
    defaults to worker processes on all cores; one that is passed in stays open. Raises ModelError for a model that
    can't be used, WorkspaceError for a folder that can't be written to, and Cancelled when ``progress`` says so. A file
    of the drive that can't be read is skipped and named in the summary's warnings.
    """
    if executor is None:
        with open_executor("processes") as own:
            return label_drive(
                drive,
                model=model,
                segmentation=segmentation,
                boxes=boxes,
                workspace=workspace,
                settings=settings,
                decisions=decisions,
                executor=own,
                progress=progress,
            )
    run = _Run(Artifacts(workspace), executor, progress or SilentProgress())
    with PeakMemory() as memory:
        chosen = settings or LabelSettings()
        if boxes is not None:
            chosen = replace(chosen, lidar=replace(chosen.lidar, method="pillars", network=str(boxes)))
        decisions = decisions or Decisions()
        results = _run_stages(run, drive, model, segmentation, chosen, decisions)
        return _summarise(run, drive, results, chosen, decisions, memory)


@dataclass(frozen=True)
class _Run:
    """What every stage of one run shares; ``seconds`` fills up as the stages go."""

    artifacts: Artifacts
    executor: Executor
    progress: Progress
    seconds: dict[str, float] = field(default_factory=dict[str, float])

    def stage(self, stage: Stage[AnyUnit], units: Sequence[AnyUnit]) -> list[Path]:
        with self.timed(stage.name):
            return run_stage(stage, units, artifacts=self.artifacts, executor=self.executor, progress=self.progress)

    @contextmanager
    def timed(self, name: str) -> Generator[None]:
        start = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[name] = round(self.seconds.get(name, 0.0) + time.perf_counter() - start, 4)


@dataclass(frozen=True)
class _Results:
    """The artifacts of a run."""

    class_names: tuple[str, ...]
    class_groups: tuple[int, ...]
    detector_seconds: float
    detections: dict[str, list[Path]]
    segmentation: dict[str, list[Path]]
    tracks: dict[str, Path]
    boxes_3d: list[Path]
    colours: list[Path]
    identities: Path
    donors: Path
    labels: dict[str, Path]
    box_warnings: tuple[str, ...]


def _run_stages(
    run: _Run, drive: Drive, model: Path, segmentation: Path | None, settings: LabelSettings, decisions: Decisions
) -> _Results:
    """The phases of a run, in order."""
    artifacts = run.artifacts
    with run.timed("detect"):
        detector = open_detector(model, settings.detection)
        detect_units = plan.detect_units(drive, detector, settings.detection, artifacts=artifacts, model=model)
        detected = detect(
            detect_units, detector, artifacts=artifacts, threads=run.executor.workers, progress=run.progress
        )
    classes = plan.Classes.of(detector)
    clips = plan.Clips.of(detect_units, detected.paths)

    segmented = _segment(run, drive, segmentation)

    with run.timed("lidar"):
        lidar, box_warnings = _usable_maker(settings.lidar, is_painted=bool(segmented.of_camera))
        lidar_units = plan.lidar_units(drive, clips, segmented, classes, lidar, artifacts=artifacts)
    boxes_3d = run.stage(LIDAR, lidar_units)

    track_units = plan.track_units(drive, clips, classes, settings.tracking)
    tracks = dict(zip(clips.of_camera, run.stage(TRACK, track_units), strict=True))

    colours = _colours(run, drive, tracks, settings.identity)
    identity_unit = plan.identity_unit(drive, tracks, boxes_3d, colours, classes, settings.identity, decisions)
    identities = run.stage(IDENTITY, [identity_unit])[0]
    donors = run.stage(DONORS, [plan.donor_unit(drive, tracks, identities, settings.propagation)])[0]
    label_units = plan.label_units(drive, tracks, identities, donors, settings.propagation)
    labels = dict(zip(tracks, run.stage(LABELS, label_units), strict=True))
    return _Results(
        classes.names,
        classes.groups,
        detected.detector_seconds,
        clips.by_camera(),
        segmented.by_camera(),
        tracks,
        boxes_3d,
        colours,
        identities,
        donors,
        labels,
        box_warnings if lidar_units and drive.has_lidar else (),
    )


def _usable_maker(config: LidarConfig, *, is_painted: bool) -> tuple[LidarConfig, tuple[str, ...]]:
    """How 3D boxes can be made: without weights where a network takes painted points and nothing paints them, which is
    told. ModelError for a network that can't be used."""
    if config.method != "pillars" or is_painted or not takes_paint(config):
        return config, ()
    told = (
        "3D boxes are made without a network: it takes LiDAR points that a segmentation has painted, and this drive "
        "was not segmented. Name a segmentation by HINDSIGHT_SEGMENTATION."
    )
    return replace(config, method="clusters", network=None), (told,)


def _colours(run: _Run, drive: Drive, tracks: Mapping[str, Path], config: IdentityConfig) -> list[Path]:
    """The colours of each camera's tracks; none where the method of merging does not look at them."""
    if config.method == BASELINE:
        return []
    return run.stage(COLOURS, plan.colour_units(drive, tracks))


def _segment(run: _Run, drive: Drive, model: Path | None) -> plan.Clips:
    """The scores of the images that can be painted; empty without a model, or where nothing can be painted."""
    if model is None:
        return plan.Clips.of([], [])
    with run.timed("segment"):
        units = plan.segment_units(drive, artifacts=run.artifacts, model=model)
        if not units:
            return plan.Clips.of([], [])
        segmenter = open_segmenter(model)
        threads = run.executor.workers
        paths = segment(units, segmenter, artifacts=run.artifacts, threads=threads, progress=run.progress)
    return plan.Clips.of(units, paths)


def _summarise(
    run: _Run, drive: Drive, results: _Results, settings: LabelSettings, decisions: Decisions, memory: PeakMemory
) -> LabelledDrive:
    identities = read_identities(results.identities)
    donors = read_donors(results.donors)
    propagated = sum(int(batch["propagated"].sum()) for path in results.labels.values() for batch in read_batches(path))
    summary = Summary(
        drive=drive.name,
        format=drive.format,
        frames=len(drive.frames),
        cameras={camera: _camera_summary(paths, camera, donors.tracks) for camera, paths in results.detections.items()},
        identities=len(set(identities.identity_of.values())),
        merges=_merge_summary(identities),
        labels_propagated=propagated,
        seconds=run.seconds,
        detector_seconds=round(results.detector_seconds, 4),
        peak_memory_mb=round(memory.peak_mb, 1),
        warnings=_warnings(drive, results),
    )
    key = key_of([path.name for path in (results.identities, *results.labels.values(), *results.boxes_3d)])
    keep_detections(run.artifacts, key, results.detections)
    keep_files(run.artifacts, key, _files_of(results, settings, decisions))
    return LabelledDrive(
        key=key,
        class_names=results.class_names,
        tracks=donors.tracks,
        merges=identities.proposals,
        identity_of=identities.identity_of,
        donors=donors.of_identity,
        propagation=settings.propagation,
        summary=summary,
        open_colours=partial(read_colours, results.colours),
        open_frames=partial(read_labelled_frames, results.tracks, results.labels, results.boxes_3d),
    )


def _files_of(results: _Results, settings: LabelSettings, decisions: Decisions) -> ResultFiles:
    return ResultFiles(
        detections={camera: tuple(paths) for camera, paths in results.detections.items()},
        tracks=results.tracks,
        boxes_3d=tuple(results.boxes_3d),
        class_names=results.class_names,
        class_groups=results.class_groups,
        tracking=settings.tracking,
        identity=settings.identity,
        propagation=settings.propagation,
        decisions=decisions,
    )


def _camera_summary(paths: Iterable[Path], camera: str, tracks: Iterable[TrackSummary]) -> CameraSummary:
    notes = [read_note(path) for path in paths]
    return CameraSummary(
        frames=sum(len(note["frames"]) for note in notes),
        detections=sum(note["detections"] for note in notes),
        tracks=sum(track.camera == camera for track in tracks),
    )


def _merge_summary(identities: Merges) -> MergeSummary:
    states = Counter(proposal.state for proposal in identities.proposals)
    return MergeSummary(
        accepted=states[MergeState.ACCEPTED],
        proposed=states[MergeState.PROPOSED],
        rejected=states[MergeState.REJECTED],
    )


def _warnings(drive: Drive, results: _Results) -> list[str]:
    warnings = [*drive.warnings, *results.box_warnings]
    for paths in (*results.detections.values(), *results.segmentation.values(), results.boxes_3d):
        for path in paths:
            warnings.extend(read_note(path)["warnings"])
    warnings.extend(calibration_warnings(agreement_of(results.boxes_3d)))
    if len(results.tracks) > 1 and not (drive.has_lidar and results.boxes_3d):
        warnings.append(
            "This drive has no LiDAR with calibrated cameras: where objects stand is guessed from how tall they look, "
            "so few tracks of different cameras are merged without a person."
        )
    return list(dict.fromkeys(warnings))  # an image that can't be read is noted by detection and by segmentation
