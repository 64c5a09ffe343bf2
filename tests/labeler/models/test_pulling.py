"""Pulling from a real server on this machine: whole, slow, broken off, wrong, absent, full, twice at once."""

import errno
import hashlib
import io
import threading
from dataclasses import dataclass, replace
from http import HTTPStatus
from pathlib import Path
from typing import IO, Any

import pytest

from labeler.models import ModelCache, ModelStoreError, OfficialModel, Pulled, pull
from labeler.models.errors import BrokenOff, DiskFull, ProxyProblem, PullError, SourceProblem, WrongBytes
from tests.labeler.models.model_server import Behaviour
from tests.labeler.models.pulling import FILE, NAME, Heard, Pulling


def part_of(cache: ModelCache) -> Path:
    return cache.folder / f"{NAME}.onnx.part"


def files_in(cache: ModelCache) -> set[str]:
    return {path.name for path in cache.folder.iterdir() if not path.name.endswith(".lock")}


def test_a_whole_file_is_kept_with_a_record(pulling: Pulling, cache: ModelCache, content: bytes, source: str) -> None:
    heard = Heard()
    pulled = pulling(heard=heard)
    assert pulled.path.read_bytes() == content
    assert (pulled.fresh, pulled.pinned) == (True, True)
    assert cache.find(NAME) == pulled.record
    assert pulled.record.sha256 == hashlib.sha256(content).hexdigest()
    assert pulled.record.source == f"{source}/{FILE}"
    assert (pulled.record.task, pulled.record.input_shape, len(pulled.record.class_names)) == (
        "detection",
        "Nx3xHxW",
        80,
    )
    assert (heard.begun, heard.came) == ([(0, len(content))], len(content))
    assert files_in(cache) == {f"{NAME}.onnx", f"{NAME}.json"}


def test_what_is_there_is_not_pulled_again(pulling: Pulling, behaviour: Behaviour) -> None:
    pulling()
    assert not pulling().fresh
    assert len(behaviour.requests) == 1


def test_progress_is_heard_while_a_slow_file_comes(
    pulling: Pulling, behaviour: Behaviour, content: bytes, cache: ModelCache
) -> None:
    half_came = threading.Event()
    heard = Heard(on_advance=lambda came: half_came.set() if came >= len(content) // 2 else None)

    def hold_the_rest_back() -> None:
        assert half_came.wait(30)
        assert not cache.path(NAME).exists()  # nothing lies there before it is whole

    behaviour.before_rest = hold_the_rest_back
    assert pulling(heard=heard).fresh


def test_what_broke_off_goes_on_from_there(
    pulling: Pulling, behaviour: Behaviour, content: bytes, cache: ModelCache
) -> None:
    behaviour.break_after = 1000
    with pytest.raises(BrokenOff, match=rf"broke off after 1,000 of {len(content):,} bytes.*pull again to go on"):
        pulling()
    assert part_of(cache).read_bytes() == content[:1000]
    with pytest.raises(BrokenOff, match="after 2,000 of"):
        pulling()
    behaviour.break_after = None
    heard = Heard()
    assert pulling(heard=heard).path.read_bytes() == content
    assert heard.begun == [(2000, len(content))]
    assert heard.came == len(content) - 2000
    assert [asked for _, asked in behaviour.requests] == [None, "bytes=1000-", "bytes=2000-"]
    assert files_in(cache) == {f"{NAME}.onnx", f"{NAME}.json"}


@pytest.mark.parametrize(
    ("change", "requests"),
    [
        ({"honours_ranges": False}, 2),  # answers 200 and the whole file
        ({"etag": '"2"'}, 2),  # another version: If-Range makes it send the whole file
        ({"content_range": "bytes 7-99/100"}, 3),  # goes on from elsewhere: asked for all of it
        ({"content_range": "bytes 1000-9/99999999"}, 3),  # a part of a file of another size
    ],
)
def test_a_part_that_can_not_be_continued_begins_anew(
    pulling: Pulling, behaviour: Behaviour, content: bytes, change: dict[str, Any], requests: int
) -> None:
    behaviour.break_after = 1000
    with pytest.raises(BrokenOff):
        pulling()
    behaviour.break_after = None
    for name, value in change.items():
        setattr(behaviour, name, value)
    heard = Heard()
    assert pulling(heard=heard).path.read_bytes() == content
    assert heard.begun == [(0, len(content))]
    assert len(behaviour.requests) == requests


def test_a_part_of_another_source_is_not_continued(
    pulling: Pulling, behaviour: Behaviour, content: bytes, source: str
) -> None:
    behaviour.break_after = 1000
    with pytest.raises(BrokenOff):
        pulling()
    behaviour.break_after = None
    pulling(mirror=f"{source}/other")
    assert behaviour.requests[-1] == (f"/other/{FILE}", None)


def test_a_part_that_was_whole_is_only_checked(
    pulling: Pulling, behaviour: Behaviour, content: bytes, cache: ModelCache
) -> None:
    behaviour.break_after = 1000
    with pytest.raises(BrokenOff):
        pulling()
    part_of(cache).write_bytes(content)  # as if it was stopped between the last byte and the check
    assert pulling().path.read_bytes() == content
    assert len(behaviour.requests) == 1


def test_a_length_that_is_not_said_is_known_from_the_registry(
    pulling: Pulling, behaviour: Behaviour, content: bytes
) -> None:
    behaviour.says_length, behaviour.break_after = False, 1000
    with pytest.raises(BrokenOff, match=rf"after 1,000 of {len(content):,} bytes"):
        pulling()
    behaviour.break_after = None
    assert pulling().path.read_bytes() == content


def test_wrong_bytes_of_the_right_size_are_not_kept(
    pulling: Pulling, behaviour: Behaviour, content: bytes, cache: ModelCache
) -> None:
    behaviour.files[FILE] = content[:-1] + b"?"
    with pytest.raises(WrongBytes, match=r"not the published yolox-nano: its sha256 is [0-9a-f]{64}, which should be"):
        pulling()
    assert files_in(cache) == set()


def test_a_file_of_another_size_is_not_even_fetched(pulling: Pulling, behaviour: Behaviour, cache: ModelCache) -> None:
    behaviour.files[FILE] += b"more"
    heard = Heard()
    with pytest.raises(WrongBytes, match=r"bytes, and the published model has"):
        pulling(heard=heard)
    assert heard.came == 0


@pytest.mark.parametrize("wrong", [b"no model at all", b""])
def test_a_file_without_a_pin_must_at_least_be_a_model(
    pulling: Pulling, behaviour: Behaviour, published: OfficialModel, cache: ModelCache, wrong: bytes
) -> None:
    behaviour.files[FILE] = wrong
    with pytest.raises(WrongBytes, match="can't be used and was deleted"):
        pulling(model=replace(published, sha256=None, size_bytes=None))
    assert files_in(cache) == set()


def test_without_a_pin_the_first_use_is_recorded(
    pulling: Pulling, published: OfficialModel, content: bytes, cache: ModelCache
) -> None:
    pulled = pulling(model=replace(published, sha256=None, size_bytes=None))
    assert not pulled.pinned
    assert pulled.record.sha256 == hashlib.sha256(content).hexdigest()


def test_a_web_page_in_place_of_the_file_is_called_so(pulling: Pulling, behaviour: Behaviour) -> None:
    behaviour.content_type = "text/html; charset=utf-8"
    with pytest.raises(ProxyProblem, match="answered with a web page instead of the file"):
        pulling()


@pytest.mark.parametrize(
    ("status", "kind", "says"),
    [
        (HTTPStatus.NOT_FOUND, SourceProblem, r"There is no file at http://127\.0\.0\.1:\d+/yolox_nano\.onnx \(404\)"),
        (HTTPStatus.SERVICE_UNAVAILABLE, SourceProblem, r"answered 503 \(Service Unavailable\)\. Pull again later"),
        (HTTPStatus.PROXY_AUTHENTICATION_REQUIRED, ProxyProblem, r"wants a login \(407\)"),
    ],
)
def test_what_a_server_refuses_is_named(
    pulling: Pulling, behaviour: Behaviour, status: int, kind: type[PullError], says: str
) -> None:
    behaviour.status = status
    with pytest.raises(kind, match=says):
        pulling()


def test_a_server_that_is_not_there_is_named(pulling: Pulling, unused_address: str) -> None:
    with pytest.raises(SourceProblem, match=r"127\.0\.0\.1:\d+ can't be reached: Connection refused"):
        pulling(mirror=unused_address)


class _FullDisk(io.BytesIO):
    """A file on a disk that has room for so many bytes more."""

    def __init__(self, path: Path, room: int) -> None:
        super().__init__()
        self._path, self._room = path, room

    def write(self, data: Any, /) -> int:
        fits = bytes(data)[: self._room]
        with self._path.open("ab") as file:
            file.write(fits)
        self._room -= len(fits)
        if len(fits) < len(data):
            raise OSError(errno.ENOSPC, "No space left on device")
        return len(fits)


def test_a_disk_that_fills_up_keeps_what_came(
    pulling: Pulling, content: bytes, cache: ModelCache, behaviour: Behaviour
) -> None:
    with pytest.raises(DiskFull, match=r"The disk that holds .*models is full\. What came of the file is kept"):
        pulling(opening=lambda path, mode: _FullDisk(path, 3000))
    assert part_of(cache).read_bytes() == content[:3000]
    assert pulling().path.read_bytes() == content
    assert behaviour.requests[-1][1] == "bytes=3000-"


def test_a_device_that_is_full_is_named(pulling: Pulling) -> None:
    def full_device(path: Path, mode: str) -> IO[bytes]:
        return Path("/dev/full").open("wb", buffering=0)

    with pytest.raises(DiskFull, match="is full"):
        pulling(opening=full_device)


def test_a_file_that_can_not_fit_is_not_begun(
    pulling: Pulling, monkeypatch: pytest.MonkeyPatch, cache: ModelCache
) -> None:
    monkeypatch.setattr("labeler.models.download.shutil.disk_usage", lambda path: _Usage(free=100))
    heard = Heard()
    with pytest.raises(DiskFull, match=r"needs 0 MB more|needs .* MB more, and the disk"):
        pulling(heard=heard)
    assert heard.begun == []


@dataclass
class _Usage:
    free: int


def test_two_pulls_at_once_make_one_download(
    pulling: Pulling, behaviour: Behaviour, cache: ModelCache, content: bytes
) -> None:
    second = Heard()
    behaviour.before_rest = lambda: None if second.waited.wait(30) else pytest.fail("the second pull did not wait")
    started = threading.Event()
    first = Heard(on_advance=lambda came: started.set())
    pulled: list[Pulled] = []
    threads = [threading.Thread(target=lambda: pulled.append(pulling(heard=first)))]
    threads[0].start()
    assert started.wait(30)
    threads.append(threading.Thread(target=lambda: pulled.append(pulling(heard=second))))
    threads[1].start()
    for thread in threads:
        thread.join()
    assert sorted(one.fresh for one in pulled) == [False, True]
    assert cache.path(NAME).read_bytes() == content
    assert len(behaviour.requests) == 1


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("sim-yolox-nano", "ships with Hindsight: there is nothing to pull"),
        ("yolox-xxl", "There is no model yolox-xxl to pull. There are: yolox-nano, .*yolox-x"),
    ],
)
def test_names_that_can_not_be_pulled(cache: ModelCache, name: str, says: str) -> None:
    with pytest.raises(ModelStoreError, match=says):
        pull(name, cache, progress=Heard())


@pytest.mark.parametrize("mirror", ["/mnt/models", "file:///mnt/models", "ftp://host/models", "https://"])
def test_a_mirror_must_be_a_web_address(pulling: Pulling, mirror: str) -> None:
    with pytest.raises(ModelStoreError, match="HINDSIGHT_MODEL_MIRROR"):
        pulling(mirror=mirror)


def test_a_folder_that_can_not_be_made_is_named(tmp_path: Path, published: OfficialModel, source: str) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(ModelStoreError, match="Name a folder that you may write to by HINDSIGHT_MODELS"):
        pull(NAME, ModelCache(tmp_path / "file" / "models"), progress=Heard(), mirror=source, official=(published,))
