"""The plan of drives is what the shipped models were trained on, so it must not move."""

import pytest

from labeler.simulation.recording import SimulationConfig
from labeler.simulation.towns import TOWNS
from labeler.training.drive_plan import training_drive, validation_drive


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
