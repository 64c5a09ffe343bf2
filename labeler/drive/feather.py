"""Columns of an Arrow feather file as numpy arrays, with errors that name the file and the column."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from labeler.drive.errors import DriveFileError


@dataclass(frozen=True, eq=False)
class FeatherTable:
    """The content of one file."""

    path: Path
    table: pa.Table

    def __len__(self) -> int:
        return self.table.num_rows

    def has(self, *columns: str) -> bool:
        return all(column in self.table.column_names for column in columns)

    def floats(self, *columns: str) -> NDArray[np.float64]:
        """(N, C) float64 of C columns; an empty cell is NaN. DriveFileError when a column is no number."""
        return np.stack([self._converted(column, np.dtype(np.float64)) for column in columns], axis=1)

    def integers(self, column: str) -> NDArray[np.int64]:
        """(N,) int64 of a column. DriveFileError when a cell is empty or no whole number."""
        if self.table.column(column).null_count:
            raise DriveFileError(f"{self.path}: the column {column} has empty cells.")
        array = self._converted(column, None)
        if not np.issubdtype(array.dtype, np.integer):
            raise DriveFileError(f"{self.path}: the column {column} must hold whole numbers, not {array.dtype}.")
        return array.astype(np.int64)

    def strings(self, column: str) -> tuple[str, ...]:
        """N strings of a column."""
        return tuple(str(value) for value in self.table.column(column).to_pylist())

    def _converted(self, column: str, dtype: np.dtype[np.float64] | None) -> NDArray[Any]:
        array = self.table.column(column).to_numpy()
        try:
            return array if dtype is None else array.astype(dtype)
        except (TypeError, ValueError) as error:
            raise DriveFileError(f"{self.path}: the column {column} must hold numbers, not {array.dtype}.") from error


def read_feather(path: Path, columns: Sequence[str]) -> FeatherTable:
    """Reads a whole file that must have the given ``columns``. DriveFileError when it can't be read or lacks one."""
    if not path.exists():
        raise DriveFileError(f"{path} is missing.")
    try:
        with pa.OSFile(str(path), "r") as stream, pa.ipc.open_file(stream) as reader:
            table = reader.read_all()
    except (OSError, pa.ArrowException) as error:
        raise DriveFileError(f"{path} can't be read as a feather file: {error}. It is truncated or damaged.") from error
    missing = [column for column in columns if column not in table.column_names]
    if missing:
        raise DriveFileError(
            f"{path} lacks the columns {', '.join(missing)}; it has {', '.join(table.column_names) or 'none'}."
        )
    return FeatherTable(path, table)
