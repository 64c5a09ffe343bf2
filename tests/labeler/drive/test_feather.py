"""Feather files: columns as numpy arrays, and errors that name the file and the column."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from labeler.drive.errors import DriveFileError
from labeler.drive.feather import read_feather

WriteTable = Callable[..., Path]


def test_reads_columns_of_any_number_type(tmp_path: Path, write_table: WriteTable) -> None:
    numbers = {"a": np.array([1, 2], np.float16), "b": np.array([3, 4], np.uint8), "t": [10**18, 10**18 + 1]}
    columns = {**numbers, "s": ["x", "y"]}
    table = read_feather(write_table(tmp_path / "a.feather", columns), ("a", "t"))
    assert table.floats("b", "a").tolist() == [[3.0, 1.0], [4.0, 2.0]]
    assert table.integers("t").tolist() == [10**18, 10**18 + 1]  # exact, though no float64 could hold it
    assert table.strings("s") == ("x", "y")
    assert len(table) == 2
    assert table.has("a", "s")
    assert not table.has("a", "z")


def test_missing_columns_are_named(tmp_path: Path, write_table: WriteTable) -> None:
    path = write_table(tmp_path / "a.feather", {"x": [1.0], "y": [1.0]})
    with pytest.raises(DriveFileError, match=r"a\.feather lacks the columns z, intensity; it has x, y\."):
        read_feather(path, ("x", "z", "intensity"))


def test_an_empty_cell_is_nan_among_floats_and_an_error_among_times(tmp_path: Path, write_table: WriteTable) -> None:
    table = read_feather(write_table(tmp_path / "a.feather", {"x": [1.0, None], "t": [1, None]}), ())
    assert np.isnan(table.floats("x")[1, 0])
    with pytest.raises(DriveFileError, match="column t has empty cells"):
        table.integers("t")


def test_text_and_fractions_are_no_whole_numbers(tmp_path: Path, write_table: WriteTable) -> None:
    table = read_feather(write_table(tmp_path / "a.feather", {"s": ["one"], "x": [1.5]}), ())
    with pytest.raises(DriveFileError, match="column s must hold numbers"):
        table.floats("s")
    with pytest.raises(DriveFileError, match="column x must hold whole numbers"):
        table.integers("x")


@pytest.mark.parametrize("kept", [0, 4, 50, 0.5, -1])  # empty, a stump, cut in the header, in the middle, at the end
def test_truncated_files_are_refused(tmp_path: Path, write_table: WriteTable, kept: float) -> None:
    path = write_table(tmp_path / "a.feather", {"x": list(range(1000))})
    data = path.read_bytes()
    path.write_bytes(data[: int(kept * len(data)) if isinstance(kept, float) else kept])
    with pytest.raises(DriveFileError, match=r"a\.feather can't be read as a feather file"):
        read_feather(path, ("x",))


def test_a_file_that_is_gone_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DriveFileError, match=r"gone\.feather is missing"):
        read_feather(tmp_path / "gone.feather", ())
