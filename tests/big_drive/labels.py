"""What the pipeline would have made of the traffic: tracks, merges with evidence, identities, labels, 3D boxes.

Merges of one object's tracks in neighbouring cameras are accepted, but for as many of the least sure ones as it takes
to leave the wanted number of identities; those are proposed. Some pairs of different objects are proposed as well.
Donors, labels and identities come from the labeler's own code.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from labeler.identity.linking import components
from labeler.identity.types import MergeEvidence, MergeKind, MergeProposal, MergeState, SharedFrame
from labeler.lidar.types import Boxes3D
from labeler.pipeline.types import LabelledDrive, LabelledFrame, LabelledView, Summary, TrackSummary
from labeler.propagation import PropagationConfig, collect_votes, donor_of, label_observations
from labeler.tracking.types import NO_DETECTION, Observations
from tests.big_drive.traffic import CAMERAS, CLASS_NAMES, Objects, Sightings

TRACKS_PER_CAMERA = 1_000_000  # the pipeline numbers each camera's tracks from a million of its own
FILLED_SHARE, CONFUSED_SHARE, WRONG_PROPOSALS = 0.06, 0.07, 100
WITH_3D_WITHIN_M = 40.0
BEST_FRAMES = 3
NO_SHARED_FRAME_SCORE = 0.35


@dataclass(frozen=True, eq=False)
class Tracked:
    """Sightings as tracks: ``track_id``, ``score`` (NaN where filled in) and ``class_id`` (N,), a row each."""

    sightings: Sightings
    track_id: NDArray[np.int64]
    score: NDArray[np.float64]
    class_id: NDArray[np.int16]


def track(sightings: Sightings, objects: Objects, random: np.random.Generator) -> Tracked:
    """One track for each object in each camera."""
    pair = sightings.camera * TRACKS_PER_CAMERA + sightings.obj
    _, first, inverse = np.unique(pair, return_index=True, return_inverse=True)
    camera_of_track = sightings.camera[first]
    within = np.arange(len(first)) - np.searchsorted(camera_of_track, camera_of_track)
    track_id = (camera_of_track * TRACKS_PER_CAMERA + within + 1)[inverse]
    score = np.clip(0.97 - 0.012 * sightings.distance_m + random.normal(0, 0.07, len(sightings)), 0.08, 0.98)
    ends = np.zeros(len(sightings), np.bool_)
    ends[first] = True
    ends[np.append(first[1:], len(sightings)) - 1] = True
    score[(random.random(len(sightings)) < FILLED_SHARE) & ~ends] = np.nan
    class_id = objects.class_id[sightings.obj].copy()
    confused = (random.random(len(sightings)) < CONFUSED_SHARE) & (sightings.distance_m > 25)
    class_id[confused] = (class_id[confused] + 1) % len(CLASS_NAMES)
    return Tracked(sightings, track_id, score, class_id)


def label(tracked: Tracked, identities: int, *, frames: int, random: np.random.Generator) -> LabelledDrive:
    """The whole result, as the app imports it."""
    sightings = tracked.sightings
    objects = len(np.unique(sightings.obj))
    tracks = _summaries(tracked)
    merges = _merges(tracked, keep_apart=identities - objects, random=random)
    pairs = [(merge.track_a, merge.track_b) for merge in merges if merge.state is MergeState.ACCEPTED]
    identity_of = components([one.track_id for one in tracks], pairs)
    order = np.lexsort((tracked.track_id, sightings.camera, sightings.frame))
    views = [
        (int(sightings.frame[rows[0]]), int(sightings.camera[rows[0]]), _observations(tracked, rows), rows)
        for rows in np.split(order, _starts(sightings.frame[order] * len(CAMERAS) + sightings.camera[order]))
    ]
    config = PropagationConfig()
    votes = collect_votes([(CAMERAS[camera], found) for _, camera, found, _ in views], identity_of, config=config)

    def open_frames() -> Iterator[LabelledFrame]:
        by_frame: dict[int, dict[str, LabelledView]] = {}
        for frame, camera, found, rows in views:
            labels = label_observations(found, identity_of, votes, config=config)
            view = LabelledView(found, labels, _boxes_3d(tracked, found, rows))
            by_frame.setdefault(frame, {})[CAMERAS[camera]] = view
        for frame, found_views in by_frame.items():
            yield LabelledFrame(frame, found_views)

    return LabelledDrive(
        key=f"big drive of {len(sightings)} boxes",
        class_names=CLASS_NAMES,
        tracks=tracks,
        merges=tuple(merges),
        identity_of=identity_of,
        donors={one: donor for one, its in votes.items() if (donor := donor_of(its, config)) is not None},
        propagation=config,
        summary=_summary(frames, tracks, merges, identities),
        open_frames=open_frames,
    )


def _starts(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """Where a new run of equal keys begins, but for the first."""
    return np.flatnonzero(np.diff(keys)) + 1


def _observations(tracked: Tracked, rows: NDArray[np.intp]) -> Observations:
    score = tracked.score[rows]
    filled = np.isnan(score)
    return Observations(
        track_id=tracked.track_id[rows].astype(np.int32),
        frame_index=tracked.sightings.frame[rows].astype(np.int32),
        xyxy_px=tracked.sightings.xyxy_px[rows].astype(np.float32),
        score=score.astype(np.float32),
        class_id=tracked.class_id[rows],
        detection_index=np.where(filled, NO_DETECTION, np.arange(len(rows))).astype(np.int32),
    )


def _boxes_3d(tracked: Tracked, found: Observations, rows: NDArray[np.intp]) -> Boxes3D:
    near = (tracked.sightings.distance_m[rows] < WITH_3D_WITHIN_M) & (found.detection_index != NO_DETECTION)
    rows, detections = rows[near], found.detection_index[near]
    if len(rows) == 0:
        return Boxes3D.empty()
    center_m = tracked.sightings.center_m[rows].astype(np.float32)
    # Each camera's points lie on the side that it sees, so the same object's boxes differ a little.
    center_m[:, :2] += 0.15 * (tracked.sightings.camera[rows, None] - 1.5)
    size_m = np.tile(np.array([[4.4, 1.8, 1.5]], np.float32), (len(rows), 1))
    return Boxes3D(
        center_m=center_m,
        size_m=size_m,
        yaw_rad=tracked.sightings.yaw_rad[rows].astype(np.float32),
        score=tracked.score[rows].astype(np.float32),
        class_id=tracked.class_id[rows],
        num_points=(400 / np.maximum(tracked.sightings.distance_m[rows], 1)).astype(np.int32),
        detection_index=detections,
        source=np.zeros(len(rows), np.int8),
        center_std_m=np.full((len(rows), 2), 0.2, np.float32),
        yaw_std_rad=np.full(len(rows), 0.1, np.float32),
        seen_m=np.concatenate([-size_m[:, :2] / 2, size_m[:, :2] / 2], axis=1).astype(np.float32),
        offset_s=np.zeros(len(rows), np.float32),
    )


def _summaries(tracked: Tracked) -> tuple[TrackSummary, ...]:
    sightings = tracked.sightings
    edges = np.concatenate([[0], _starts(tracked.track_id), [len(sightings)]])
    found: list[TrackSummary] = []
    for start, stop in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        best = start + int(np.nanargmax(tracked.score[start:stop]))
        found.append(
            TrackSummary(
                track_id=int(tracked.track_id[start]),
                camera=CAMERAS[int(sightings.camera[start])],
                first_frame=int(sightings.frame[start]),
                last_frame=int(sightings.frame[stop - 1]),
                observation_count=stop - start,
                best_score=float(tracked.score[best]),
                best_frame=int(sightings.frame[best]),
                class_id=int(tracked.class_id[best]),
            )
        )
    return tuple(found)


def _merges(tracked: Tracked, *, keep_apart: int, random: np.random.Generator) -> list[MergeProposal]:
    """Merges of each object's tracks in the order of time, the ``keep_apart`` least sure ones proposed, and proposals
    that are wrong; best first."""
    sightings = tracked.sightings
    edges = np.concatenate([[0], _starts(tracked.track_id), [len(sightings)]]).tolist()
    rows_of = {int(tracked.track_id[a]): np.arange(a, b) for a, b in pairwise(edges)}
    of_object: dict[int, list[int]] = {}
    for track_id, rows in sorted(rows_of.items(), key=lambda one: (sightings.frame[one[1][0]], one[0])):
        of_object.setdefault(int(sightings.obj[rows[0]]), []).append(track_id)
    handovers = [pair for members in of_object.values() for pair in pairwise(members)]
    true = sorted((_claim(tracked, rows_of, a, b) for a, b in handovers), key=lambda claim: claim.score)
    if not 0 <= keep_apart <= len(true):
        raise ValueError(f"{keep_apart} of {len(true)} merges can't be left to a person; ask for other counts")
    proposed = [_decided(claim, MergeState.PROPOSED) for claim in true[:keep_apart]]
    accepted = [_decided(claim, MergeState.ACCEPTED) for claim in true[keep_apart:]]
    wrong = _wrong_pairs(tracked, rows_of, random)
    unsure = [_decided(_claim(tracked, rows_of, a, b), MergeState.PROPOSED) for a, b in wrong]
    return sorted([*accepted, *proposed, *unsure], key=lambda claim: -claim.score)


def _wrong_pairs(
    tracked: Tracked, rows_of: Mapping[int, NDArray[np.intp]], random: np.random.Generator
) -> list[tuple[int, int]]:
    """Pairs of tracks of different objects in different cameras that share a frame."""
    sightings, track_ids = tracked.sightings, list(rows_of)
    pairs: set[tuple[int, int]] = set()
    while len(pairs) < min(WRONG_PROPOSALS, len(track_ids) // 4):
        a, b = sorted(random.choice(track_ids, 2).tolist())
        first, second = rows_of[a], rows_of[b]
        other_object = sightings.obj[first[0]] != sightings.obj[second[0]]
        other_camera = sightings.camera[first[0]] != sightings.camera[second[0]]
        if other_object and other_camera and np.isin(sightings.frame[first], sightings.frame[second]).any():
            pairs.add((a, b))
    return sorted(pairs)


def _claim(tracked: Tracked, rows_of: Mapping[int, NDArray[np.intp]], one: int, other: int) -> MergeProposal:
    """A merge with the evidence that the 3D boxes give; its score falls with their distance."""
    sightings = tracked.sightings
    track_a, track_b = sorted((one, other))
    rows_a, rows_b = rows_of[track_a], rows_of[track_b]
    _, in_a, in_b = np.intersect1d(sightings.frame[rows_a], sightings.frame[rows_b], return_indices=True)
    between = sightings.center_m[rows_a[in_a], :2] - sightings.center_m[rows_b[in_b], :2]
    distances_m = np.hypot(between[:, 0], between[:, 1]) + 0.15 + 0.02 * sightings.distance_m[rows_a[in_a]]
    overlaps = np.clip(1 - distances_m / 2.5, 0, 1)
    agreeing = int((distances_m < 1.0).sum())
    shared = len(distances_m)
    best = np.argsort(distances_m, kind="stable")[:BEST_FRAMES]
    if shared:
        score = float(0.2 + 0.75 * np.exp(-distances_m.min()) * min(1, 0.6 + 0.1 * agreeing))
    else:
        score = NO_SHARED_FRAME_SCORE
    return MergeProposal(
        track_a=track_a,
        camera_a=CAMERAS[int(sightings.camera[rows_a[0]])],
        track_b=track_b,
        camera_b=CAMERAS[int(sightings.camera[rows_b[0]])],
        score=score,
        state=MergeState.PROPOSED,
        shared_frames=shared,
        agreeing_frames=agreeing,
        mean_distance_m=float(distances_m.mean()) if shared else None,
        mean_bev_iou=float(overlaps.mean()) if shared else None,
        best_frames=tuple(
            SharedFrame(
                frame_index=int(sightings.frame[rows_a[in_a[row]]]),
                distance_m=float(distances_m[row]),
                bev_iou=float(overlaps[row]),
                iou_3d=float(overlaps[row] * 0.9),
            )
            for row in best.tolist()
        ),
        reason=f"boxes at the same place in {agreeing} of {shared} shared frames",
        evidence=MergeEvidence(MergeKind.OVERLAP if shared else MergeKind.HANDOVER, calibrated=False),
    )


def _decided(claim: MergeProposal, state: MergeState) -> MergeProposal:
    return replace(claim, state=state)


def _summary(frames: int, tracks: Sequence[TrackSummary], merges: Sequence[MergeProposal], identities: int) -> Summary:
    states = Counter(merge.state for merge in merges)
    of_camera = Counter(one.camera for one in tracks)
    return Summary(
        drive="big drive",
        format="argoverse2",
        frames=frames,
        cameras={name: {"frames": frames, "detections": 0, "tracks": of_camera[name]} for name in CAMERAS},
        identities=identities,
        merges={
            "accepted": states[MergeState.ACCEPTED],
            "proposed": states[MergeState.PROPOSED],
            "rejected": states[MergeState.REJECTED],
        },
        labels_propagated=0,
        seconds={},
        detector_seconds=0.0,
        peak_memory_mb=0.0,
        warnings=[],
    )
