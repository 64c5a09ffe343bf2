"""How arrays are stored: Arrow files, one record batch per clip of frames, read one batch at a time.

A table's columns are the fields of a frozen dataclass of arrays (Detections, Observations, Boxes3D, Labels) and
``frame_index``; (N, K) fields are lists of fixed size K. Rows are sorted by frame, and a frame never spans two batches.
A note in the schema's metadata holds what rows can't say, such as warnings.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pyarrow
from numpy.typing import NDArray

from labeler.detection.types import Detections
from labeler.lidar.types import Boxes3D, Positions3D
from labeler.propagation.types import Labels
from labeler.tracking.types import Observations

Columns = Mapping[str, NDArray[Any]]
Table = TypeVar("Table", Detections, Observations, Boxes3D, Positions3D, Labels)

_NOTE = b"note"

pa: Any = pyarrow  # its types are partial


def columns_of(
    rows: Detections | Observations | Boxes3D | Positions3D | Labels, **more: NDArray[Any]
) -> dict[str, NDArray[Any]]:
    """The arrays of a dataclass by field name, and ``more`` columns beside them."""
    return {field.name: getattr(rows, field.name) for field in fields(rows)} | more


def rows_of(kind: type[Table], columns: Columns) -> Table:
    """The dataclass ``kind`` from columns; columns that it does not have are left aside."""
    return kind(**{field.name: columns[field.name] for field in fields(kind)})


def concatenate(parts: list[dict[str, NDArray[Any]]]) -> dict[str, NDArray[Any]]:
    """One set of columns from at least one."""
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def write_table(
    path: Path, batches: Iterable[Columns], *, note: Mapping[str, Any] | None = None, compressed: bool = False
) -> None:
    """Write at least one batch (it may have no rows) of equal columns to an Arrow file, ``compressed`` by zstd."""
    iterator = iter(batches)
    first = _record_batch(next(iterator))
    schema = first.schema.with_metadata({_NOTE: json.dumps(note or {}).encode()})
    options = pa.ipc.IpcWriteOptions(compression="zstd" if compressed else None)
    with pa.OSFile(str(path), "wb") as sink, pa.ipc.new_file(sink, schema, options=options) as writer:
        writer.write_batch(first.cast(schema))
        for columns in iterator:
            writer.write_batch(_record_batch(columns).cast(schema))


def read_batches(path: Path) -> Iterator[dict[str, NDArray[Any]]]:
    """The batches of a table in order; no more than one is in memory at a time."""
    with pa.OSFile(str(path), "rb") as source:
        reader = pa.ipc.open_file(source)
        for number in range(reader.num_record_batches):
            batch = reader.get_batch(number)
            yield {name: _to_numpy(batch.column(name)) for name in batch.schema.names}


def read_batch(path: Path, number: int) -> dict[str, NDArray[Any]]:
    """One batch of a table, without reading the others."""
    with pa.OSFile(str(path), "rb") as source:
        batch = pa.ipc.open_file(source).get_batch(number)
        return {name: _to_numpy(batch.column(name)) for name in batch.schema.names}


def read_note(path: Path) -> dict[str, Any]:
    """The note of a table."""
    with pa.OSFile(str(path), "rb") as source:
        return json.loads(pa.ipc.open_file(source).schema.metadata[_NOTE])


def rows_by_frame(batches: Iterable[Columns]) -> Iterator[tuple[int, dict[str, NDArray[Any]]]]:
    """(frame_index, the rows of that frame) in order; frames without rows do not appear."""
    for columns in batches:
        frames = columns["frame_index"]
        if len(frames) == 0:
            continue
        starts = np.flatnonzero(np.diff(frames, prepend=frames[0] - 1))
        stops = np.append(starts[1:], len(frames))
        for start, stop in zip(starts, stops, strict=True):
            yield int(frames[start]), {name: column[start:stop] for name, column in columns.items()}


def _record_batch(columns: Columns) -> Any:
    return pa.RecordBatch.from_arrays([_to_arrow(column) for column in columns.values()], names=list(columns))


def _to_arrow(column: NDArray[Any]) -> Any:
    if column.ndim == 1:
        return pa.array(column)
    flat = pa.array(np.ascontiguousarray(column).reshape(-1))
    return pa.FixedSizeListArray.from_arrays(flat, column.shape[1])


def _to_numpy(column: Any) -> NDArray[Any]:
    if isinstance(column, pa.FixedSizeListArray):
        return column.flatten().to_numpy(zero_copy_only=False).reshape(-1, column.type.list_size)
    return column.to_numpy(zero_copy_only=False)
