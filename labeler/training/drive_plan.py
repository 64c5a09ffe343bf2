"""Which drives the shipped models learned from, and how to make them again.

Many short drives, two seconds from moment to moment, instead of a few long ones: a new town says more than a new
second. Everything about a drive follows from its number: the kind of town, how much traffic, how many parked cars, how
strong the JPEG is; the light follows from the seed. Drives for validation have seeds of their own, so their towns are
unseen.
"""

from __future__ import annotations

from pathlib import Path

from labeler.simulation.recording import Progress, SimulationConfig, simulate_drive
from labeler.simulation.towns import TOWNS

_TRAINING_SEEDS, _VALIDATION_SEEDS = 50_000, 90_000
_TRAINING_FRAMES, _VALIDATION_FRAMES = 16, 8
_RATE_HZ = 0.5
_LIDAR_CHANNELS, _LIDAR_COLUMNS = (32, 48, 64, 96), (1024, 1440, 1800)
_PARKED_SHARES = (0.3, 0.5, 0.7)


def training_drive(number: int) -> SimulationConfig:
    """The settings of training drive ``number``, from 0."""
    return _drive(_TRAINING_SEEDS + number, number, _TRAINING_FRAMES)


def validation_drive(number: int) -> SimulationConfig:
    """The settings of validation drive ``number``, from 0."""
    return _drive(_VALIDATION_SEEDS + number, number + 1, _VALIDATION_FRAMES)


def _drive(seed: int, variant: int, frames: int) -> SimulationConfig:
    towns = tuple(TOWNS)
    return SimulationConfig(
        seed=seed,
        frames=frames,
        rate_hz=_RATE_HZ,
        town=towns[variant % len(towns)],
        vehicles=30 + variant * 37 % 61,
        parked_share=_PARKED_SHARES[variant % len(_PARKED_SHARES)],
        jpeg_quality=80 + 5 * (variant % 4),
        lidar_channels=_LIDAR_CHANNELS[variant // 4 % len(_LIDAR_CHANNELS)],
        lidar_columns=_LIDAR_COLUMNS[variant % len(_LIDAR_COLUMNS)],
        semantic=True,
    )


def simulate_planned(folder: Path, *, training: int, validation: int, progress: Progress) -> None:
    """Record the planned drives as ``folder``/training/train0... and ``folder``/validation/val0...; those that are
    there are left alone, so a run that was stopped goes on. SimulationError as for ``simulate_drive``."""
    wanted = {Path("training", f"train{number}"): training_drive(number) for number in range(training)}
    wanted |= {Path("validation", f"val{number}"): validation_drive(number) for number in range(validation)}
    for name, config in wanted.items():
        if not (folder / name).exists():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            simulate_drive(folder / name, config, progress)
