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

    chosen = choose_boxes("mine", cache)
    assert chosen is not None
    assert (chosen.path, chosen.origin) == (cache.path("mine"), Origin.ADDED)
    by_file = choose_boxes(file, cache)
    assert by_file is not None
    assert (by_file.path, by_file.origin) == (file, Origin.FILE)


def test_a_name_that_no_network_has_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ModelStoreError, match="There is no boxes model other"):
        choose_boxes("other", ModelCache(tmp_path))


def test_a_file_that_says_too_little_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="but not which classes"):
        inspect(write_network(tmp_path / "p.onnx", said={"classes": "car"}))
