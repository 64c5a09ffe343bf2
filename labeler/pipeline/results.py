"""Which detections a result was made from: kept by the result's key, so that they are found again beside its labels."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

from labeler.pipeline.artifacts import Artifacts, write_json
from labeler.pipeline.detecting import STAGE, read_detections
from labeler.tracking import DetectedFrame

_RESULTS = "result"


def keep_detections(artifacts: Artifacts, key: str, detections: Mapping[str, Sequence[Path]]) -> None:
    """Note the artifacts of detection, by camera and in order of time, under the key of a result."""
    path = artifacts.path(_RESULTS, key, "json")
    if not path.exists():
        keys = {camera: [clip.stem for clip in clips] for camera, clips in detections.items()}
        artifacts.make(path, lambda temporary: write_json(temporary, keys))


def find_detections(workspace: Path, key: str) -> dict[str, Callable[[], Iterator[DetectedFrame]]] | None:
    """For each camera a pass over the detections that the result of that key was made from, in order of frames.

    None where the workspace does not have all of them any more."""
    artifacts = Artifacts(workspace)
    path = artifacts.path(_RESULTS, key, "json")
    if not path.exists():
        return None
    keys: dict[str, list[str]] = json.loads(path.read_bytes())
    clips = {
        camera: [artifacts.path(STAGE, clip_key, "arrow") for clip_key in of_camera]
        for camera, of_camera in keys.items()
    }
    if not all(clip.exists() for of_camera in clips.values() for clip in of_camera):
        return None
    return {camera: partial(read_detections, of_camera) for camera, of_camera in clips.items()}
