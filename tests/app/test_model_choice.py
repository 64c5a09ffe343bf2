"""Which networks label a drive, by the settings and by where the drive comes from."""

from pathlib import Path

import pytest

from app.model_choice import boxes_file
from app.settings import Settings


@pytest.mark.parametrize(
    ("simulated", "segmentation", "boxes", "chosen"),
    [
        (True, None, None, "sim-pillars.onnx"),
        (True, "none", None, None),  # nothing paints its points
        (True, None, "clusters", None),
        (True, "none", "sim-pillars", "sim-pillars.onnx"),  # named; the run says that it can't be used
        (False, None, None, None),  # recorded: the network has seen none
        (False, "sim-segmentation", None, None),
        (False, None, "sim-pillars", "sim-pillars.onnx"),
    ],
)
def test_the_network_that_ships_boxes_simulated_drives_that_are_painted(
    simulated: bool, segmentation: str | None, boxes: str | None, chosen: str | None, tmp_path: Path
) -> None:
    if simulated:
        (tmp_path / "simulation.json").write_text("{}")
    settings = Settings(models=tmp_path / "models", segmentation=segmentation, boxes=boxes)
    found = boxes_file(settings, tmp_path)
    assert (found.name if found else None) == chosen
