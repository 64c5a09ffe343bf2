"""Which model does the work."""

from pathlib import Path

import pytest

from labeler.models import ModelCache, ModelStoreError, Task, available, choose_detector, choose_segmentation
from labeler.models.inspection import Inspected
from tests.made_models import write_segmentation_model


@pytest.fixture
def cache(tmp_path: Path) -> ModelCache:
    return ModelCache(tmp_path / "models")


def put(cache: ModelCache, name: str, task: Task = Task.DETECTION) -> None:
    """A model in the cache that nobody will open."""
    cache.folder.mkdir(exist_ok=True)
    (cache.folder / "part").write_bytes(b"model")
    inspected = Inspected(task, "Nx3xHxW", ("car",))
    cache.keep(cache.folder / "part", name, inspected, sha256="0" * 64, source="here", licence="MIT")


@pytest.mark.parametrize(
    ("present", "chosen"),
    [
        ([], "sim-yolox-nano"),
        (["mine"], "sim-yolox-nano"),  # what a user added must be named
        (["yolox-nano"], "yolox-nano"),
        (["yolox-s", "yolox-x", "yolox-tiny"], "yolox-x"),
        (["yolox-s", "yolox-m", "mine"], "yolox-m"),
    ],
)
def test_without_a_name_the_best_official_model_is_taken(cache: ModelCache, present: list[str], chosen: str) -> None:
    for name in present:
        put(cache, name)
    assert choose_detector(None, cache).name == chosen


def test_a_segmentation_is_no_detector(cache: ModelCache) -> None:
    put(cache, "seg", Task.SEGMENTATION)
    assert [choice.name for choice in available(Task.DETECTION, cache)] == ["sim-yolox-nano"]
    with pytest.raises(ModelStoreError, match="There is no detection model seg"):
        choose_detector("seg", cache)


@pytest.mark.parametrize("name", ["yolox-nano", "mine", "sim-yolox-nano"])
def test_a_name_finds_its_model(cache: ModelCache, name: str) -> None:
    put(cache, "yolox-nano")
    put(cache, "mine")
    put(cache, "yolox-x")
    choice = choose_detector(name, cache)
    assert (choice.name, choice.path.stem) == (name, name)


@pytest.mark.parametrize("named", ["made.onnx", "./made.onnx", "sub/made", "~/made.onnx"])
def test_a_path_is_taken_as_it_is(
    cache: ModelCache, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, named: str
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    choice = choose_detector(named, cache)
    assert choice.name == "made"
    assert choice.path.is_absolute()
    assert choice.path.is_relative_to(tmp_path)


def test_a_file_in_this_folder_needs_no_suffix_unless_a_model_has_its_name(
    cache: ModelCache, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("weights", "mine"):
        (tmp_path / name).touch()
    put(cache, "mine")
    assert choose_detector("weights", cache).path == tmp_path / "weights"
    assert choose_detector("mine", cache).path == cache.path("mine")


def test_names_that_lead_nowhere_say_what_to_do(cache: ModelCache) -> None:
    with pytest.raises(ModelStoreError, match=r"Get it: hindsight models pull yolox-l$"):
        choose_detector("yolox-l", cache)
    with pytest.raises(ModelStoreError, match=r"no detection model yolo\. On this machine there are: sim-yolox-nano\."):
        choose_detector("yolo", cache)


@pytest.mark.parametrize(
    ("named", "simulated", "has_notice"),
    [
        (None, True, False),  # made for it
        (None, False, True),
        ("sim-yolox-nano", False, True),  # naming it makes it no better
        ("yolox-nano", False, False),
        ("./mine.onnx", False, False),  # the user knows what it was trained on
    ],
)
def test_the_shipped_detector_comes_with_a_notice_on_real_roads(
    cache: ModelCache, named: str | None, simulated: bool, has_notice: bool
) -> None:
    if named == "yolox-nano":
        put(cache, "yolox-nano")
    notice = choose_detector(named, cache).notice(simulated=simulated)
    assert (notice is not None) == has_notice
    assert notice is None or "hindsight models pull yolox-x" in notice


@pytest.mark.parametrize(
    ("named", "simulated", "chosen"),
    [
        (None, True, "sim-segmentation"),
        (None, False, None),  # trained on simulated drives: no help on real roads
        ("none", True, None),
        ("seg", False, "seg"),
        ("sim-segmentation", False, "sim-segmentation"),
    ],
)
def test_segmentation(
    cache: ModelCache, tmp_path: Path, named: str | None, simulated: bool, chosen: str | None
) -> None:
    cache.add(write_segmentation_model(tmp_path / "s.onnx"), "seg")
    choice = choose_segmentation(named, cache, simulated=simulated)
    assert (choice.name if choice else None) == chosen
