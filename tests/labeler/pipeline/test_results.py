from pathlib import Path

import numpy as np

from labeler.identity import Decisions, IdentityConfig
from labeler.pipeline.artifacts import Artifacts
from labeler.pipeline.results import ResultFiles, find_detections, find_files, keep_detections, keep_files
from labeler.pipeline.tables import write_table
from labeler.propagation import PropagationConfig
from labeler.tracking import TrackingConfig


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


def test_what_a_result_was_made_from_is_found_where_the_workspace_is_now(tmp_path: Path):
    artifacts = Artifacts(tmp_path / "before")
    clip, tracks = (write_clip(artifacts, name, 0) for name in ("clip-1", "tracks-1"))
    files = ResultFiles(
        detections={"front": (clip,)},
        tracks={"front": tracks},
        boxes_3d=(),
        class_groups=(0, 1),
        tracking=TrackingConfig(method="two_stage"),
        identity=IdentityConfig(max_gap_s=3.0),
        propagation=PropagationConfig(rule="top-k", top_k=3),
        decisions=Decisions(),
    )
    keep_files(artifacts, "a result", files)
    assert find_files(tmp_path / "before", "a result") == files
    assert find_files(tmp_path / "before", "never made") is None
    (tmp_path / "before").rename(tmp_path / "after")
    found = find_files(tmp_path / "after", "a result")
    assert found is not None
    assert found.paths() == [tmp_path / "after" / path.relative_to(tmp_path / "before") for path in (clip, tracks)]
    found.tracks["front"].unlink()
    assert find_files(tmp_path / "after", "a result") is None
