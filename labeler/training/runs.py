"""A whole training: drives in, an ONNX file out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from labeler.inference import CPU_PROVIDER
from labeler.models import sha256_of
from labeler.segmentation import open_segmenter
from labeler.training.calibration import find_calibration, with_calibration
from labeler.training.clouds import load_clouds
from labeler.training.detector import DetectorTask
from labeler.training.devices import device_of, workers_for
from labeler.training.loop import Trained, train
from labeler.training.onnx_export import export_detector, export_pillars, export_segmentation, import_onnx
from labeler.training.pictures import Picture, find_drives, load_pictures
from labeler.training.pillar_network import PillarNetwork
from labeler.training.pillar_task import PillarTask
from labeler.training.recipes import DETECTOR, UNPAINTED_PILLARS, Device, Recipe
from labeler.training.segmenter import SegmentationTask
from labeler.training.state import kept_workers
from labeler.training.task import Task, TrainingConfig
from labeler.training.yolox_network import Yolox

_CALIBRATED_ON = 192
"""About how many of the images, evenly spread, the scores are fitted on."""


def train_recipe(
    recipe: Recipe,
    folder: Path,
    drives: Sequence[Path],
    *,
    steps: int,
    seed: int,
    batch_size: int,
    workers: int | None,
    device: Device,
    report: Callable[[str], None],
) -> Path:
    """Train a recipe's model in ``folder``, going on where a checkpoint stands, and write it there: the ONNX file.

    ``drives`` are drives or folders of drives. ``workers`` None are those of the
    checkpoint, or else the recipe's on the CPU, and what the cores allow beside a GPU. ``report`` hears how far it is.
    TrainingError when a part of the extra ``training`` is missing, when the device can't be used, when a drive can't be
    learned from, when the checkpoint is of other settings, or when ``folder`` can't be written."""
    import_onnx()
    on = device_of(device)
    config = TrainingConfig(
        seed=seed,
        steps=steps,
        batch_size=batch_size,
        workers=_workers(recipe, folder, workers, device, batch_size),
        learning_rate=recipe.learning_rate,
    )
    found = find_drives(drives)
    report(f"reading {len(found)} drives")
    pictures = load_pictures(found)
    names = [drive.name for drive in found]
    report(f"{len(pictures)} images, {sum(len(p.boxes_px) for p in pictures)} vehicles")
    task: Task[Any, Any]
    if recipe is DETECTOR:
        task = DetectorTask(pictures, names, recipe.crops)
    else:
        task = SegmentationTask(pictures, names, *recipe.crops)
    trained = train(task, config, folder, device=on, report=report)
    file = folder / recipe.file_name
    source = source_of(recipe, config, trained)
    if isinstance(trained.network, Yolox):
        export_detector(_calibrated(trained.network, pictures, report), file, source=source)
    else:
        export_segmentation(trained.network, file, source=source)
    return file


def train_pillars(
    recipe: Recipe,
    folder: Path,
    drives: Sequence[Path],
    *,
    painter: Path,
    clouds: Path,
    steps: int,
    seed: int,
    batch_size: int,
    workers: int | None,
    device: Device,
    report: Callable[[str], None],
) -> Path:
    """Train the pillar network as :func:`train_recipe` does its models. ``painter`` is the segmentation that paints the
    clouds, which are kept in the folder ``clouds``: several runs may share them."""
    import_onnx()
    on = device_of(device)
    config = TrainingConfig(
        seed=seed,
        steps=steps,
        batch_size=batch_size,
        workers=_workers(recipe, folder, workers, device, batch_size),
        learning_rate=recipe.learning_rate,
    )
    found = find_drives(drives)
    segmenter = open_segmenter(painter, providers=(CPU_PROVIDER,))
    sweeps = load_clouds(found, segmenter, clouds, painter=sha256_of(painter), report=report)
    report(f"{len(sweeps)} camera directions, {sum(int(sweep.asked.sum()) for sweep in sweeps)} vehicles")
    painted = recipe is not UNPAINTED_PILLARS
    task = PillarTask(sweeps, [drive.name for drive in found], painted=painted)
    trained = train(task, config, folder, device=on, report=report)
    file = folder / recipe.file_name
    assert isinstance(trained.network, PillarNetwork)
    export_pillars(trained.network, file, source=source_of(recipe, config, trained))
    return file


def _workers(recipe: Recipe, folder: Path, asked: int | None, device: Device, batch_size: int) -> int:
    if asked is not None:
        return asked
    return kept_workers(folder) or (recipe.workers if device is Device.CPU else workers_for(batch_size))


def _calibrated(network: Yolox, pictures: Sequence[Picture], report: Callable[[str], None]) -> Yolox:
    report("fitting the scores to how often the detector is right")
    calibration = find_calibration(network, pictures[:: max(1, len(pictures) // _CALIBRATED_ON)])
    if calibration is None:
        report("it is too seldom right, or wrong, to tell: the scores stay as they are")
        return network
    return with_calibration(network, calibration)


def source_of(recipe: Recipe, config: TrainingConfig, trained: Trained) -> str:
    """What a file says about where it comes from."""
    drives = "; ".join(f"from step {step}: {', '.join(names)}" for step, names in trained.drives_since)
    devices = "; ".join(f"from step {step} with --device {name}" for step, name in trained.devices_since)
    return (
        f"trained on simulated drives: hindsight train {recipe.task} --seed {config.seed} --steps {config.steps} "
        f"--batch-size {config.batch_size} --workers {config.workers} ({devices}; {drives})"
    )
