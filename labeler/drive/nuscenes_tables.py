"""Rows of nuScenes tables, without loading the big ones.

``sample_data.json`` and ``ego_pose.json`` of the whole dataset hold 2.6 million rows in about 1 GB each, and parsing
them whole takes several GB of memory. So the file is mapped, the wanted key is searched for as text, and only the rows
that hold a wanted value are parsed: the cost is one pass over the file, about 2 s per GB, and no memory to speak of.
This works because the rows of these tables hold no object of their own.
"""

from __future__ import annotations

import json
import mmap
import re
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any, cast

from labeler.drive.errors import DriveError

Row = dict[str, Any]


def read_table(path: Path) -> list[Row]:
    """All rows of a small table. DriveError when it can't be read."""
    try:
        rows = json.loads(path.read_bytes())
    except (OSError, ValueError) as error:
        raise _unusable(path, error) from error
    if not isinstance(rows, list):
        raise DriveError(f"The table {path} must be a list of rows.")
    return cast("list[Row]", rows)


def rows_where(path: Path, key: str, values: Collection[str]) -> list[Row]:
    """Those rows of a table of any size whose ``key`` has one of the ``values``. DriveError when it can't be read."""
    wanted = frozenset(value.encode() for value in values)
    try:
        with path.open("rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as text:
            if text[-64:].rstrip()[-1:] != b"]":
                raise DriveError(f"The table {path} is truncated: it does not end with a bracket.")
            return list(_matching_rows(text, key, wanted))
    except (OSError, ValueError) as error:  # mmap raises ValueError for an empty file
        raise _unusable(path, error) from error


def _matching_rows(text: mmap.mmap, key: str, wanted: frozenset[bytes]) -> Iterator[Row]:
    for match in re.finditer(rb'"%s"\s*:\s*"([^"]*)"' % re.escape(key.encode()), text):
        if match[1] in wanted:
            start, end = text.rfind(b"{", 0, match.start()), text.find(b"}", match.end())
            yield cast("Row", json.loads(text[start : end + 1]))


def _unusable(path: Path, error: Exception) -> DriveError:
    return DriveError(f"The table {path} can't be read: {error}. Unpack the nuScenes archive again.")
