"""The cache: adding files of the user's, records, and whether files are still what they were."""

import json
from pathlib import Path

import pytest

from labeler.inference import ModelError
from labeler.models import ModelCache, ModelStoreError, Task, sha256_of, verify
from tests.made_models import write_segmentation_model


@pytest.fixture
def cache(tmp_path: Path) -> ModelCache:
    return ModelCache(tmp_path / "cache" / "models")


def test_an_empty_cache_has_no_records(cache: ModelCache) -> None:
    assert cache.records() == []
    assert not cache.folder.exists()  # looking makes nothing


def test_a_detector_is_added_with_what_it_says(cache: ModelCache, made_model: Path) -> None:
    record = cache.add(made_model, "made", licence="MIT")
    assert cache.path("made").read_bytes() == made_model.read_bytes()
    assert (record.task, record.input_shape, record.licence) == (Task.DETECTION, "Nx3xHxW", "MIT")
    assert record.class_names[:3] == ("person", "bicycle", "car")
    assert (record.sha256, record.size_bytes) == (sha256_of(made_model), made_model.stat().st_size)
    assert record.source == str(made_model)
    assert cache.records() == [record]
    assert cache.add(made_model, "made", licence="MIT") == record  # once more changes nothing


def test_a_segmentation_is_told_from_a_detector(cache: ModelCache, tmp_path: Path) -> None:
    file = write_segmentation_model(tmp_path / "s.onnx", hw=(64, 96), batch=1, metadata={"classes": '["a", "b"]'})
    record = cache.add(file, "seg.1_x-y")
    assert (record.task, record.input_shape, record.class_names) == (Task.SEGMENTATION, "1x3x64x96", ("a", "b"))


@pytest.mark.parametrize("name", ["", "Made", "a b", "../up", ".hidden", "a/b", "-a", "a" * 65, "a\n"])
def test_names_that_are_no_file_names_are_refused(cache: ModelCache, made_model: Path, name: str) -> None:
    with pytest.raises(ModelStoreError, match="can't be the name of a model"):
        cache.add(made_model, name)
    assert not cache.folder.exists()


@pytest.mark.parametrize("name", ["yolox-x", "sim-yolox-nano"])
def test_names_of_the_registry_are_taken(cache: ModelCache, made_model: Path, name: str) -> None:
    with pytest.raises(ModelStoreError, match="Choose another name"):
        cache.add(made_model, name)


def test_a_name_of_another_file_is_taken(cache: ModelCache, made_model: Path, tmp_path: Path) -> None:
    cache.add(made_model, "made")
    with pytest.raises(ModelStoreError, match="There is another model made"):
        cache.add(write_segmentation_model(tmp_path / "other.onnx"), "made")
    assert cache.path("made").read_bytes() == made_model.read_bytes()


def test_a_file_that_is_no_model_is_not_added(cache: ModelCache, tmp_path: Path) -> None:
    (tmp_path / "notes.onnx").write_text("not a model")
    with pytest.raises(ModelError, match="can't be opened as an ONNX model"):
        cache.add(tmp_path / "notes.onnx", "notes")
    assert cache.records() == []


def test_a_record_that_is_broken_or_alone_counts_as_none(cache: ModelCache, made_model: Path) -> None:
    cache.add(made_model, "made")
    record = cache.folder / "made.json"
    whole = record.read_text("utf-8")
    record.write_text(whole[:20], encoding="utf-8")
    assert cache.records() == []
    record.write_text(json.dumps(json.loads(whole) | {"name": "other"}), encoding="utf-8")
    assert cache.records() == []  # copied by hand: it says another name
    record.write_text(whole, encoding="utf-8")
    assert len(cache.records()) == 1
    cache.path("made").unlink()
    assert cache.records() == []


def test_a_file_that_changed_is_found_out(cache: ModelCache, made_model: Path) -> None:
    cache.add(made_model, "made")
    assert [verdict.is_right for verdict in verify(cache) if verdict.name == "made"] == [True]
    with cache.path("made").open("ab") as file:
        file.write(b"?")
    assert [verdict.is_right for verdict in verify(cache) if verdict.name == "made"] == [False]
