"""The units of work that may run in a worker process: a camera's tracks, a clip's 3D boxes, and what follows."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter

from labeler.identity import Decisions, IdentityConfig, Merges, Rig, find_merges
from labeler.pipeline.artifacts import write_json
from labeler.pipeline.colouring import read_colours
from labeler.pipeline.detecting import read_detections
from labeler.pipeline.reading import read_observations, read_views
from labeler.pipeline.stages import Stage
from labeler.pipeline.tables import columns_of, concatenate, read_batches, rows_of, write_table
from labeler.pipeline.types import TrackSummary
from labeler.propagation import Donor, PropagationConfig, Votes, collect_votes, donor_of, label_observations
from labeler.tracking import CameraMotion, DetectedFrame, Observations, TrackingConfig, open_tracker

_FRAMES_PER_BATCH = 64


@dataclass(frozen=True)
class TrackUnit:
    """Tracking inside one camera, over the whole drive; ``motion`` is the camera's, where it counts."""

    key: str
    detections: tuple[Path, ...]
    config: TrackingConfig
    class_groups: tuple[int, ...]
    first_track_id: int
    effort: int
    motion: CameraMotion | None = None


@dataclass(frozen=True)
class IdentityUnit:
    """Merges over the whole drive; ``tracks`` is each camera's artifact, ``boxes_3d`` are the clips' in order,
    ``colours`` the cameras' that have images."""

    key: str
    tracks: Mapping[str, Path]
    boxes_3d: tuple[Path, ...]
    colours: tuple[Path, ...]
    config: IdentityConfig
    class_groups: tuple[int, ...]
    rig: Rig
    decisions: Decisions
    effort: int = 0


def track(unit: TrackUnit, path: Path) -> None:
    """Write the observations of one camera's tracks, in order of frames."""
    track_detections(
        read_detections(unit.detections),
        path,
        unit.config,
        class_groups=unit.class_groups,
        first_track_id=unit.first_track_id,
        motion=unit.motion,
    )


def track_detections(
    frames: Iterable[DetectedFrame],
    path: Path,
    config: TrackingConfig,
    *,
    class_groups: Sequence[int],
    first_track_id: int,
    motion: CameraMotion | None,
) -> None:
    """Write the observations of the tracks in one camera's frames, in order of frames. ``motion`` is the camera's,
    where boxes are to be predicted by it."""
    tracker = open_tracker(config, class_groups=class_groups, motion=motion)
    write_table(path, _batched(tracker.track(frames, first_track_id=first_track_id)))


def find_identities(unit: IdentityUnit, path: Path) -> None:
    """Write the merge proposals and the identity of every track."""
    frames = read_views(unit.tracks, unit.boxes_3d)
    result = find_merges(
        frames,
        unit.config,
        class_groups=unit.class_groups,
        rig=unit.rig,
        colours=read_colours(unit.colours),
        decisions=unit.decisions,
    )
    write_json(path, result)


@dataclass(frozen=True)
class DonorUnit:
    """The best observations of every identity, over the whole drive; ``timestamp_ns`` (F,) are the frames' times."""

    key: str
    tracks: Mapping[str, Path]
    identities: Path
    config: PropagationConfig
    timestamp_ns: NDArray[np.int64]
    effort: int = 0


@dataclass(frozen=True)
class LabelUnit:
    """The labels of one camera's observations; ``timestamp_ns`` (F,) are the frames' times."""

    key: str
    tracks: Path
    identities: Path
    donors: Path
    config: PropagationConfig
    timestamp_ns: NDArray[np.int64]
    effort: int = 0


@dataclass(frozen=True)
class Donors:
    """The votes of each identity, its donor where it has one, and all tracks in a few numbers."""

    votes: dict[int, Votes]
    of_identity: dict[int, Donor]
    tracks: tuple[TrackSummary, ...]


def choose_donors(unit: DonorUnit, path: Path) -> None:
    """Write the votes and the donor of every identity, and a summary of every track."""
    identity_of = read_identities(unit.identities).identity_of
    batches = (
        (camera, rows_of(Observations, columns))
        for camera, file in unit.tracks.items()
        for columns in read_batches(file)
    )
    votes = collect_votes(batches, identity_of, config=unit.config, timestamp_ns=unit.timestamp_ns)
    donors = {identity: donor for identity, one in votes.items() if (donor := donor_of(one, unit.config)) is not None}
    tracks = [summary for camera, file in unit.tracks.items() for summary in summarise_tracks(camera, file)]
    write_json(path, Donors(votes, donors, tuple(tracks)))


def label_camera(unit: LabelUnit, path: Path) -> None:
    """Write a label for every observation of one camera, row by row."""
    identity_of = read_identities(unit.identities).identity_of
    votes = read_donors(unit.donors).votes
    batches = (rows_of(Observations, columns) for columns in read_batches(unit.tracks))
    labels = (
        label_observations(batch, identity_of, votes, config=unit.config, timestamp_ns=unit.timestamp_ns)
        for batch in batches
    )
    write_table(path, (columns_of(batch) for batch in labels))


TRACK = Stage("track", 3, "arrow", track)
IDENTITY = Stage("identity", 5, "json", find_identities)
DONORS = Stage("donors", 3, "json", choose_donors)
LABELS = Stage("labels", 3, "arrow", label_camera)


def read_identities(path: Path) -> Merges:
    """What :func:`find_identities` wrote."""
    return TypeAdapter(Merges).validate_json(path.read_bytes())


def read_donors(path: Path) -> Donors:
    """What :func:`choose_donors` wrote."""
    return TypeAdapter(Donors).validate_json(path.read_bytes())


def summarise_tracks(camera: str, path: Path) -> list[TrackSummary]:
    """A summary of every track of one camera, by track id."""
    summaries: dict[int, TrackSummary] = {}
    for frame_index, rows in read_observations(path):
        for row, track_id in enumerate(rows.track_id.tolist()):
            seen = summaries.get(track_id)
            score, class_id = float(rows.score[row]), int(rows.class_id[row])
            if seen is None:
                summaries[track_id] = TrackSummary(
                    track_id, camera, frame_index, frame_index, 1, score, frame_index, class_id
                )
                continue
            seen = replace(seen, last_frame=frame_index, observation_count=seen.observation_count + 1)
            if not (math.isnan(score) or score <= seen.best_score):  # a box that was filled in has no score
                seen = replace(seen, best_score=score, best_frame=frame_index, class_id=class_id)
            summaries[track_id] = seen
    return [summaries[track_id] for track_id in sorted(summaries)]


def _batched(observations: Iterable[Observations]) -> Iterator[dict[str, NDArray[Any]]]:
    """Columns of several frames at a time; at least one batch."""
    yield columns_of(Observations.empty())
    frames = iter(observations)
    while some := list(islice(frames, _FRAMES_PER_BATCH)):
        yield concatenate([columns_of(frame) for frame in some])
