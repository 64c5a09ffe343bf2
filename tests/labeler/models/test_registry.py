"""The registry: names, addresses, and the models that ship."""

import re

import pytest

from labeler.models import OFFICIAL, SHIPPED, OfficialModel, ShippedModel, sha256_of
from labeler.models.inspection import inspect
from labeler.models.registry import registered_names


def test_names_are_unique_and_in_the_order_of_size() -> None:
    assert registered_names() == (
        "sim-yolox-nano",
        "sim-segmentation",
        "sim-pillars",
        *("yolox-nano", "yolox-tiny", "yolox-s", "yolox-m", "yolox-l", "yolox-x"),
    )
    sizes = [model.size_bytes or 0 for model in OFFICIAL]
    assert sizes == sorted(sizes)


@pytest.mark.parametrize("model", OFFICIAL, ids=lambda model: model.name)
def test_official_models_are_those_of_the_release(model: OfficialModel) -> None:
    assert model.url == (
        f"https://github.com/Megvii-BaseDetection/YOLOX/releases/download/0.1.1rc0/{model.name.replace('-', '_')}.onnx"
    )
    assert model.sha256 is not None
    assert re.fullmatch("[0-9a-f]{64}", model.sha256)
    assert len(model.class_names) == 80


@pytest.mark.parametrize("model", SHIPPED, ids=lambda model: model.name)
def test_what_ships_is_what_the_registry_says(model: ShippedModel) -> None:
    assert sha256_of(model.path) == model.sha256
    assert inspect(model.path).task is model.task
    assert model.path.with_suffix(".md").read_text("utf-8").startswith("# ")


def test_what_ships_is_small() -> None:
    assert sum(model.path.stat().st_size for model in SHIPPED) < 6_000_000
