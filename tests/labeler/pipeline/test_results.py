from pathlib import Path

import numpy as np

from labeler.pipeline.artifacts import Artifacts
from labeler.pipeline.results import find_detections, keep_detections
from labeler.pipeline.tables import write_table


def write_clip(artifacts: Artifacts, key: str, frame_index: int) -> Path:
    """The artifact of a clip with one image, and one detection in it."""
    columns = {
        "xyxy_px": np.zeros((1, 4), np.float32),
        "score": np.array([0.5], np.float32),
        "class_id": np.zeros(1, np.int16),
        "frame_index": np.array([frame_index], np.int32),
    }
    note = {"frames": [frame_index], "timestamps_ns": [100 * frame_index]}
    return artifacts.make(artifacts.path("detect", key, "arrow"), lambda path: write_table(path, [columns], note=note))


def test_detections_are_found_by_the_key_of_their_result(tmp_path: Path):
    artifacts = Artifacts(tmp_path)
    front = [write_clip(artifacts, f"clip{number}-1", number) for number in (0, 16)]
    keep_detections(artifacts, "a result", {"front": front, "left": []})
    keep_detections(artifacts, "another", {"front": front[:1]})
    found = find_detections(tmp_path, "a result")
    assert found is not None
    assert {camera: [frame.frame_index for frame in frames()] for camera, frames in found.items()} == {
        "front": [0, 16],
        "left": [],
    }
    assert [len(frame.detections) for frame in found["front"]()] == [1, 1]  # a second pass


def test_all_of_them_or_none(tmp_path: Path):
    artifacts = Artifacts(tmp_path)
    front = [write_clip(artifacts, f"clip{number}-1", number) for number in (0, 16)]
    keep_detections(artifacts, "a result", {"front": front})
    front[1].unlink()
    assert find_detections(tmp_path, "a result") is None
    assert find_detections(tmp_path, "never made") is None


def test_a_workspace_that_was_moved_still_finds_them(tmp_path: Path):
    artifacts = Artifacts(tmp_path / "before")
    keep_detections(artifacts, "a result", {"front": [write_clip(artifacts, "clip-1", 3)]})
    (tmp_path / "before").rename(tmp_path / "after")
    found = find_detections(tmp_path / "after", "a result")
    assert found is not None
    assert [frame.frame_index for frame in found["front"]()] == [3]
