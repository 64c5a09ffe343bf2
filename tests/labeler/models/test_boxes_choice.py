"""Which network makes 3D boxes, and how a pillar network's file is recognised."""

from pathlib import Path

import pytest

from labeler.inference import ModelError
from labeler.models import ModelCache, ModelStoreError, Origin, Task, choose_boxes
from labeler.models.inspection import inspect
from tests.labeler.lidar.pillars.made_network import CLASSES, write_network


def test_a_pillar_network_is_recognised_and_can_be_added_and_named(tmp_path: Path) -> None:
    cache = ModelCache(tmp_path / "models")
    file = write_network(tmp_path / "mine.onnx")
    inspected = inspect(file)
    assert (inspected.task, inspected.input_shape, inspected.class_names) == (Task.BOXES, "Nx8x13", CLASSES)

    cache.add(file, "mine")

    chosen = choose_boxes("mine", cache, simulated=False)
    assert chosen is not None
    assert (chosen.path, chosen.origin) == (cache.path("mine"), Origin.ADDED)
    by_file = choose_boxes(file, cache, simulated=False)
    assert by_file is not None
    assert (by_file.path, by_file.origin) == (file, Origin.FILE)


@pytest.mark.parametrize(
    ("named", "simulated", "chosen"),
    [
        (None, True, "sim-pillars"),  # all that it knows
        (None, False, None),
        ("clusters", True, None),
        ("sim-pillars", False, "sim-pillars"),
    ],
)
def test_the_network_that_ships_is_for_simulated_drives_unless_it_is_named(
    named: str | None, simulated: bool, chosen: str | None, tmp_path: Path
) -> None:
    found = choose_boxes(named, ModelCache(tmp_path), simulated=simulated)
    assert (found.name if found else None) == chosen


def test_a_name_that_no_network_has_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ModelStoreError, match="There is no boxes model other"):
        choose_boxes("other", ModelCache(tmp_path), simulated=True)


def test_a_file_that_says_too_little_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="but not which classes"):
        inspect(write_network(tmp_path / "p.onnx", said={"classes": "car"}))
