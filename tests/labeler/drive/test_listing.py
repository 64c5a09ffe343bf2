"""Lists of numbered files, and what is said about those that are left out."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from labeler.drive.listing import (
    IMAGE_SUFFIXES,
    LARGEST_NS,
    counted,
    folders_in,
    list_numbered_files,
    some_of,
    whole_number,
)


def _listed(folder: Path, names: list[str], *, empty: tuple[str, ...] = ()) -> tuple[list[tuple[int, str]], list[str]]:
    for name in (*names, *empty):
        (folder / name).write_bytes(b"" if name in empty else b"content")
    warnings: list[str] = []
    found = list_numbered_files(folder, IMAGE_SUFFIXES, warnings)
    return [(number, path.name) for number, path in found], warnings


def test_files_come_by_number_not_by_name(tmp_path: Path) -> None:
    found, warnings = _listed(tmp_path, ["9.jpg", "10.JPG", "0002.png", ".7.jpg", "notes.txt"])
    assert found == [(2, "0002.png"), (9, "9.jpg"), (10, "10.JPG")]
    assert warnings == []


def test_what_is_left_out_is_told_once_per_kind(tmp_path: Path) -> None:
    bad = [f"frame_{index}.jpg" for index in range(2000)]
    found, warnings = _listed(tmp_path, ["1.jpg", "1.png", *bad], empty=("2.jpg",))
    assert found == [(1, "1.jpg")]
    assert warnings == [
        f"In {tmp_path}, skipped 2,000 files not named by a whole number: "
        "frame_0.jpg, frame_1.jpg, frame_10.jpg and 1,997 more.",
        f"In {tmp_path}, skipped 1 file empty (0 bytes): 2.jpg.",
        f"In {tmp_path}, skipped 1 file of a number that another file already has: 1.png.",
    ]


def test_a_folder_of_other_files_says_which(tmp_path: Path) -> None:
    found, warnings = _listed(tmp_path, ["1.webp", "2.webp"])
    assert found == []
    assert warnings == [f"In {tmp_path}, none of the 2 files (.webp) can be read."]


def test_no_folder_has_no_files(tmp_path: Path) -> None:
    warnings: list[str] = []
    assert list_numbered_files(tmp_path / "gone", IMAGE_SUFFIXES, warnings) == []
    assert folders_in(tmp_path / "gone") == []
    assert warnings == []


def test_hidden_folders_are_passed_over(tmp_path: Path) -> None:
    for name in ("b", "a", ".git"):
        (tmp_path / name).mkdir()
    assert [folder.name for folder in folders_in(tmp_path)] == ["a", "b"]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0", 0),
        ("000012", 12),
        (str(LARGEST_NS), LARGEST_NS),
        (str(LARGEST_NS + 1), None),  # would overflow
        ("9" * 5000, None),  # int() itself refuses so many digits
        ("-1", None),
        ("1_000", None),  # int() would take it
        (" 1", None),
        ("٣", None),  # a digit, but not a plain one
        ("1.5", None),
        ("", None),
    ],
)
def test_whole_number(text: str, expected: int | None) -> None:
    assert whole_number(text) == expected


@given(st.integers(0, LARGEST_NS), st.integers(0, 10))
def test_whole_number_reads_what_was_written(number: int, zeros: int) -> None:
    assert whole_number("0" * zeros + str(number)) == number


@pytest.mark.parametrize(
    ("names", "expected"),
    [([], ""), (["a"], "a"), (["a", "b", "c"], "a, b, c"), (["a", "b", "c", "d"], "a, b, c and 1 more")],
)
def test_some_of(names: list[str], expected: str) -> None:
    assert some_of(names) == expected


def test_counted() -> None:
    assert [counted(count, "file") for count in (0, 1, 2000)] == ["0 files", "1 file", "2,000 files"]
