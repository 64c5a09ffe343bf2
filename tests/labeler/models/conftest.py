"""A server on this machine with one made model, and a cache to pull it into."""

import hashlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import onnx
import pytest
from onnx import helper

from labeler.models import ModelCache, OfficialModel, Pulled, pull
from tests.labeler.models.model_server import Behaviour, serving
from tests.labeler.models.pulling import FILE, NAME, Heard, Pulling


@pytest.fixture(autouse=True)
def no_proxy_of_this_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("http_proxy", "https_proxy", "all_proxy", "no_proxy"):
        monkeypatch.delenv(name, raising=False)
        monkeypatch.delenv(name.upper(), raising=False)


@pytest.fixture
def content(made_model: Path) -> bytes:
    """The made detector, filled up to 100 kB."""
    model = onnx.load(str(made_model))
    helper.set_model_props(model, {"filling": "x" * 100_000})
    return model.SerializeToString()


@pytest.fixture
def behaviour(content: bytes) -> Behaviour:
    return Behaviour(files={FILE: content})


@pytest.fixture
def source(behaviour: Behaviour) -> Iterator[str]:
    with serving(behaviour) as address:
        yield address


@pytest.fixture
def published(content: bytes) -> OfficialModel:
    return OfficialModel(NAME, FILE, hashlib.sha256(content).hexdigest(), len(content), "Nx3xHxW")


@pytest.fixture
def cache(tmp_path: Path) -> ModelCache:
    return ModelCache(tmp_path / "models")


@pytest.fixture
def pulling(cache: ModelCache, source: str, published: OfficialModel) -> Pulling:
    """Pull the made model from the server."""

    def run(
        *, mirror: str = source, model: OfficialModel = published, heard: Heard | None = None, **how: Any
    ) -> Pulled:
        return pull(NAME, cache, progress=heard or Heard(), mirror=mirror, official=(model,), **how)

    return run


@pytest.fixture
def unused_address() -> str:
    with serving(Behaviour()) as address:
        return address  # the server has ended when this is used
