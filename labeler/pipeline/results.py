"""Which files a result was made from: kept by the result's key, so that they are found again beside its labels."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from pydantic import TypeAdapter

from labeler.identity import Decisions, IdentityConfig
from labeler.pipeline.artifacts import Artifacts, write_json
from labeler.pipeline.detecting import STAGE, read_detections
from labeler.propagation import PropagationConfig
from labeler.tracking import DetectedFrame, TrackingConfig

_RESULTS = "result"
_FILES = "files"


@dataclass(frozen=True)
class ResultFiles:
    """All that labels are made from once images and sweeps are read: the artifacts of detection by camera and in order
    of time, of tracking by camera, of the LiDAR step, the detector's classes and the groups that it may waver within,
    and the settings of what follows. Results from before tracking knew the car's motion have no ``class_names``."""

    detections: Mapping[str, tuple[Path, ...]]
    tracks: Mapping[str, Path]
    boxes_3d: tuple[Path, ...]
    class_groups: tuple[int, ...]
    tracking: TrackingConfig
    identity: IdentityConfig
    propagation: PropagationConfig
    decisions: Decisions
    class_names: tuple[str, ...] = ()

    def moved(self, move: Callable[[Path], Path]) -> ResultFiles:
        """The same with other paths."""
        return replace(
            self,
            detections={camera: tuple(map(move, clips)) for camera, clips in self.detections.items()},
            tracks={camera: move(path) for camera, path in self.tracks.items()},
            boxes_3d=tuple(map(move, self.boxes_3d)),
        )

    def paths(self) -> list[Path]:
        """Every file."""
        clips = [clip for of_camera in self.detections.values() for clip in of_camera]
        return [*clips, *self.tracks.values(), *self.boxes_3d]


def keep_files(artifacts: Artifacts, key: str, files: ResultFiles) -> None:
    """Note what a result was made from, under its key; places are relative to the workspace, which may move."""
    path = artifacts.path(_FILES, key, "json")
    if not path.exists():
        content = _FILES_AS_JSON.dump_json(files.moved(lambda one: one.relative_to(artifacts.root)))
        artifacts.make(path, lambda temporary: _write_bytes(temporary, content))


def find_files(workspace: Path, key: str) -> ResultFiles | None:
    """What the result of that key was made from; None where the workspace does not have all of it any more."""
    artifacts = Artifacts(workspace)
    path = artifacts.path(_FILES, key, "json")
    if not path.exists():
        return None
    files = _FILES_AS_JSON.validate_json(path.read_bytes()).moved(lambda one: artifacts.root / one)
    return files if all(one.exists() for one in files.paths()) else None


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


_FILES_AS_JSON = TypeAdapter(ResultFiles)


def _write_bytes(path: Path, content: bytes) -> None:
    path.write_bytes(content)
