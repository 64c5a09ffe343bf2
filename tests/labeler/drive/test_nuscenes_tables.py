"""Rows of big tables are found without parsing the rest."""

import json
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from labeler.drive.errors import DriveError
from labeler.drive.nuscenes_tables import read_table, rows_where

_ROWS = [
    {"token": "1", "sample_token": "a", "translation": [1.5, 2], "name": 'he said "hi"'},
    {"token": "2", "sample_token": "b", "translation": []},
    {"sample_token": "a", "token": "3", "next": ""},
]


@pytest.mark.parametrize("indent", [None, 0, 4])
@pytest.mark.parametrize(
    ("key", "values", "tokens"),
    [
        ("sample_token", {"a"}, ["1", "3"]),  # several rows, in the file's order
        ("token", {"2", "3"}, ["2", "3"]),  # "token" is no part of "sample_token"
        ("token", {"a"}, []),  # a value of another key
        ("token", set[str](), []),
        ("nothing", {"a"}, []),
    ],
)
def test_rows_where(tmp_path: Path, indent: int | None, key: str, values: set[str], tokens: list[str]) -> None:
    path = tmp_path / "t.json"
    path.write_text(json.dumps(_ROWS, indent=indent))
    assert [row["token"] for row in rows_where(path, key, values)] == tokens
    assert read_table(path) == _ROWS


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.lists(st.fixed_dictionaries({"k": st.sampled_from("abc"), "x": st.lists(st.floats(-1, 1))})), st.integers(0, 3)
)
def test_rows_where_equals_reading_all(tmp_path: Path, rows: list[dict[str, object]], indent: int) -> None:
    path = tmp_path / "t.json"
    path.write_text(json.dumps(rows, indent=indent))
    assert rows_where(path, "k", {"a", "c"}) == [row for row in rows if row["k"] != "b"]


@pytest.mark.parametrize("content", ["", '[{"token": "1"}, {"tok', "no json"])
def test_a_broken_table_is_refused(tmp_path: Path, content: str) -> None:
    path = tmp_path / "t.json"
    path.write_text(content)
    with pytest.raises(DriveError, match=r"t\.json"):
        rows_where(path, "token", {"1"})
    with pytest.raises(DriveError, match=r"t\.json"):
        read_table(path)


def test_a_table_must_be_a_list(tmp_path: Path) -> None:
    path = tmp_path / "t.json"
    path.write_text("{}")
    with pytest.raises(DriveError, match="must be a list of rows"):
        read_table(path)
