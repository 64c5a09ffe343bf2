"""Artifacts appear whole or not at all, and their keys follow what they are made from."""

import errno
import os
from dataclasses import dataclass
from pathlib import Path

import pytest

from labeler.pipeline.artifacts import Artifacts, WorkspaceError, key_of, write_json


@dataclass(frozen=True)
class _Config:
    threshold: float = 0.5


def test_a_key_follows_every_part() -> None:
    keys = {
        key_of("a", 1, _Config()),
        key_of("a", 2, _Config()),
        key_of("b", 1, _Config()),
        key_of("a", 1, _Config(threshold=0.6)),
        key_of("a", 1, {"threshold": 0.6, "x": None}),
    }
    assert len(keys) == 5
    assert key_of({"x": 1, "y": 2}) == key_of({"y": 2, "x": 1})


def test_a_key_of_what_has_no_plain_form_is_refused() -> None:
    with pytest.raises(TypeError, match="object can't be part"):
        key_of(object())


def test_an_artifact_that_fails_half_way_leaves_nothing(tmp_path: Path) -> None:
    artifacts = Artifacts(tmp_path)
    path = artifacts.path("stage", "key", "json")

    def fail(temporary: Path) -> None:
        temporary.write_text("half")
        raise ValueError("in the middle")

    with pytest.raises(ValueError, match="in the middle"):
        artifacts.make(path, fail)
    assert list(path.parent.iterdir()) == []


def test_a_full_disk_is_named_as_such(tmp_path: Path) -> None:
    artifacts = Artifacts(tmp_path)

    def full(temporary: Path) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with pytest.raises(WorkspaceError, match=r"disk that holds .* is full"):
        artifacts.make(artifacts.path("stage", "key", "json"), full)


def test_a_workspace_that_is_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(WorkspaceError, match="Name a workspace folder"):
        Artifacts(tmp_path / "file")


def test_leftovers_of_dead_processes_are_removed_and_of_living_ones_kept(tmp_path: Path) -> None:
    folder = tmp_path / "artifacts" / "stage"
    folder.mkdir(parents=True)
    nobody = 2**22 + 1  # above the largest process id of Linux
    dead = folder / f".key.json.{nobody}.0123abcd.tmp"
    living = folder / f".key.json.{os.getpid()}.0123abcd.tmp"
    for leftover in (dead, living):
        leftover.write_text("half")
    Artifacts(tmp_path)
    assert not dead.exists()
    assert living.exists()


def test_a_content_hash_follows_bytes_and_order_not_names(tmp_path: Path) -> None:
    artifacts = Artifacts(tmp_path / "workspace")
    one, two, copy = tmp_path / "one", tmp_path / "two words", tmp_path / "copy"
    one.write_bytes(b"1")
    two.write_bytes(b"2")
    copy.write_bytes(b"1")
    before = artifacts.content_hash([one, two])
    assert artifacts.content_hash([copy, two]) == before
    assert artifacts.content_hash([two, one]) != before
    one.write_bytes(b"changed")
    assert artifacts.content_hash([one, two]) != before


def test_a_content_hash_of_a_missing_file_is_that_of_an_absent_one(tmp_path: Path) -> None:
    artifacts = Artifacts(tmp_path / "workspace")
    present = tmp_path / "present"
    present.write_bytes(b"1")
    assert artifacts.content_hash([tmp_path / "missing"]) != artifacts.content_hash([present])


def test_json_is_written_with_dataclasses(tmp_path: Path) -> None:
    write_json(tmp_path / "file.json", {"config": _Config()})
    assert (tmp_path / "file.json").read_text() == '{"config": {"threshold": 0.5}}'
