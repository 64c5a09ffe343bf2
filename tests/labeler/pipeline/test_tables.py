"""Tables give back what was written, a batch and a frame at a time."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from labeler.detection import Detections
from labeler.pipeline.tables import (
    columns_of,
    concatenate,
    read_batches,
    read_note,
    rows_by_frame,
    rows_of,
    write_table,
)


def _detections(scores: list[float]) -> Detections:
    count = len(scores)
    boxes = np.arange(4 * count, dtype=np.float32).reshape(count, 4)
    return Detections(boxes, np.array(scores, np.float32), np.arange(count, dtype=np.int16))


@pytest.mark.parametrize("scores", [[0.5, 0.25, float("nan")], [0.5], []])
def test_rows_come_back_as_they_were(tmp_path: Path, scores: list[float]) -> None:
    written = _detections(scores)
    frame_index = np.full(len(scores), 7, np.int32)
    write_table(tmp_path / "t", [columns_of(written, frame_index=frame_index)], note={"warnings": ["a b"]})
    (columns,) = read_batches(tmp_path / "t")
    read = rows_of(Detections, columns)
    np.testing.assert_array_equal(read.xyxy_px, written.xyxy_px)
    np.testing.assert_array_equal(read.score, written.score)
    assert (read.xyxy_px.dtype, read.score.dtype, read.class_id.dtype) == (np.float32, np.float32, np.int16)
    np.testing.assert_array_equal(columns["frame_index"], frame_index)
    assert read_note(tmp_path / "t") == {"warnings": ["a b"]}


def test_batches_stay_apart(tmp_path: Path) -> None:
    parts = [
        columns_of(_detections([0.1] * count), frame_index=np.full(count, frame, np.int32))
        for frame, count in ((0, 2), (1, 0), (2, 1))
    ]
    write_table(tmp_path / "t", [concatenate(parts[:2]), parts[2]])
    assert [len(batch["score"]) for batch in read_batches(tmp_path / "t")] == [2, 1]
    assert [(frame, len(rows["score"])) for frame, rows in rows_by_frame(read_batches(tmp_path / "t"))] == [
        (0, 2),
        (2, 1),
    ]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=40)
@given(frames=st.lists(st.integers(0, 30), max_size=40).map(sorted))
def test_frames_come_in_order_each_with_its_rows(frames: list[int]) -> None:
    columns = {"frame_index": np.array(frames, np.int32), "row": np.arange(len(frames))}
    seen = [(frame, rows["row"].tolist()) for frame, rows in rows_by_frame([columns])]
    expected = {frame: [row for row, of in enumerate(frames) if of == frame] for frame in frames}
    assert seen == list(expected.items())
