"""Lists the recorded files of one sensor: files named by a whole number, in order of that number.

What can't be used is left out and told in one sentence per folder and kind, not in one per file.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from labeler.drive.errors import DriveError

IMAGE_SUFFIXES = frozenset({".jpg", ".jpeg", ".png"})
LARGEST_NS = 2**62 - 1
"""The latest moment (in 2116), so that twice a distance in time still fits 64 bits."""


@dataclass
class _Skipped:
    not_numbers: list[str] = field(default_factory=list[str])
    empty: list[str] = field(default_factory=list[str])
    repeated: list[str] = field(default_factory=list[str])
    other_suffixes: Counter[str] = field(default_factory=Counter[str])


def list_numbered_files(
    folder: Path, suffixes: frozenset[str], warnings: list[str], *, largest: int = LARGEST_NS
) -> list[tuple[int, Path]]:
    """(number, path) of each file ``<number><suffix>`` of a folder, by increasing number; [] when there is no folder.

    Hidden files are passed over. Files whose name is no number or which are empty, and the second of two files of one
    number, are left out; ``warnings`` gets a sentence for each kind."""
    found: dict[int, Path] = {}
    skipped = _Skipped()
    for name, size_bytes in _files_in(folder):
        stem, dot, ending = name.rpartition(".")  # pathlib takes ten times as long
        if (suffix := (dot + ending).lower()) not in suffixes:
            skipped.other_suffixes[suffix if dot else "no suffix"] += 1
        elif (number := whole_number(stem, largest=largest)) is None:
            skipped.not_numbers.append(name)
        elif size_bytes == 0:
            skipped.empty.append(name)
        elif number in found:
            skipped.repeated.append(name)
        else:
            found[number] = folder / name
    warnings.extend(_told(folder, skipped, found_any=bool(found)))
    return sorted(found.items())


def whole_number(text: str, *, largest: int = LARGEST_NS) -> int | None:
    """The number from 0 to ``largest`` that a name spells in plain digits, or None."""
    if not (text.isascii() and text.isdigit()) or len(text) > 40:
        return None
    number = int(text)
    return number if number <= largest else None


def folders_in(folder: Path) -> list[Path]:
    """The folders directly inside of a folder by name, without hidden ones; [] when there is no such folder.

    DriveError when the folder can't be read."""
    try:
        if not folder.is_dir():
            return []
        return sorted(child for child in folder.iterdir() if child.is_dir() and not child.name.startswith("."))
    except OSError as error:
        raise DriveError(f"The folder {folder} can't be read: {error.strerror}. Check its permissions.") from error


def some_of(names: Iterable[str], *, at_most: int = 3) -> str:
    """``a, b, c and 5 more``: the first names, and how many there are beside."""
    listed: Sequence[str] = list(names)
    rest = len(listed) - at_most
    return ", ".join(listed[:at_most]) + (f" and {rest:,} more" if rest > 0 else "")


def counted(count: int, noun: str) -> str:
    """``1 file``, ``2,000 files``."""
    return f"{count:,} {noun}" + ("" if count == 1 else "s")


def _files_in(folder: Path) -> list[tuple[str, int]]:
    try:
        if not folder.is_dir():
            return []
        with os.scandir(folder) as entries:
            return sorted((e.name, e.stat().st_size) for e in entries if not e.name.startswith(".") and e.is_file())
    except OSError as error:
        raise DriveError(f"The folder {folder} can't be read: {error.strerror}. Check its permissions.") from error


def _told(folder: Path, skipped: _Skipped, *, found_any: bool) -> list[str]:
    told: list[str] = []
    for names, what in (
        (skipped.not_numbers, "not named by a whole number"),
        (skipped.empty, "empty (0 bytes)"),
        (skipped.repeated, "of a number that another file already has"),
    ):
        if names:
            told.append(f"In {folder}, skipped {counted(len(names), 'file')} {what}: {some_of(names)}.")
    if skipped.other_suffixes and not found_any:
        kinds = some_of(sorted(skipped.other_suffixes))
        told.append(
            f"In {folder}, none of the {counted(skipped.other_suffixes.total(), 'file')} ({kinds}) can be read."
        )
    return told
