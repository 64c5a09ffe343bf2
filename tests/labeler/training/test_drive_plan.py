"""The plan of drives is what the shipped models were trained on, so it must not move."""

from pathlib import Path

import pytest

from labeler.simulation.recording import SimulationConfig
from labeler.simulation.towns import TOWNS
from labeler.training import drive_plan
from labeler.training.drive_plan import simulate_planned, training_drive, validation_drive
from labeler.training.pictures import find_drives


@pytest.mark.parametrize(
    ("config", "seed", "frames", "town", "vehicles", "parked", "quality", "channels", "columns"),
    [
        (training_drive(0), 50_000, 16, 0, 30, 0.3, 80, 32, 1024),
        (training_drive(5), 50_005, 16, 1, 30 + 185 % 61, 0.7, 85, 48, 1800),
        (training_drive(39), 50_039, 16, 3, 30 + 1443 % 61, 0.3, 95, 48, 1024),
        (validation_drive(0), 90_000, 8, 1, 67, 0.5, 85, 32, 1440),  # varied like training drive 1
    ],
)
def test_what_follows_from_a_number(
    config: SimulationConfig, seed: int, frames: int, town: int, vehicles: int, parked: float, quality: int,
    channels: int, columns: int,
) -> None:  # fmt: skip
    assert (config.seed, config.frames, config.town, config.vehicles) == (seed, frames, tuple(TOWNS)[town], vehicles)
    assert (config.parked_share, config.jpeg_quality) == (parked, quality)
    assert (config.lidar_channels, config.lidar_columns) == (channels, columns)
    assert (config.rate_hz, config.semantic, config.light) == (0.5, True, None)


def test_no_seed_is_both_learned_from_and_validated_with() -> None:
    learned = {training_drive(number).seed for number in range(1000)}
    assert learned.isdisjoint(validation_drive(number).seed for number in range(1000))


class _Quiet:
    def stage(self, name: str, units: int) -> None: ...

    def advance(self, units: int = 1) -> None: ...


def test_what_is_there_is_left_alone_and_the_two_kinds_are_apart(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recorded: list[tuple[str, SimulationConfig]] = []

    def record(folder: Path, config: SimulationConfig, progress: object) -> None:
        (folder / "sensors").mkdir(parents=True)
        recorded.append((folder.relative_to(tmp_path).as_posix(), config))

    monkeypatch.setattr(drive_plan, "simulate_drive", record)
    (tmp_path / "training" / "train1" / "sensors").mkdir(parents=True)

    simulate_planned(tmp_path, training=3, validation=1, progress=_Quiet())

    assert recorded == [
        ("training/train0", training_drive(0)),
        ("training/train2", training_drive(2)),
        ("validation/val0", validation_drive(0)),
    ]
    assert [drive.name for drive in find_drives([tmp_path / "training"])] == ["train0", "train1", "train2"]
