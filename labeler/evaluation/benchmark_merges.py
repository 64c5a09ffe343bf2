"""How well are tracks merged? Measured on a drive's truth with made observations, so that no detector is needed.

The tracker runs once over the observations of :mod:`labeler.evaluation.made_observations`; each method of merging gets
its tracks and 3D boxes. Because each made detection knows its object, so does each track: that of most of its boxes. A
track most of whose boxes lie on nothing is of no object, and wrong to merge with any.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from labeler.detection.classes import suppression_group_of
from labeler.drive import Poses
from labeler.evaluation.made_observations import NOTHING, MadeFrame, Noise, Scene, make_frames
from labeler.evaluation.made_observations.noise import CLASS_NAMES
from labeler.evaluation.matching import overlapping_pairs
from labeler.evaluation.tracking import TrackingRows, idf1
from labeler.identity import CameraView, IdentityConfig, MultiCameraFrame, Rig, SharedFrames, find_merges
from labeler.pipeline.plan import motion_over
from labeler.tracking import DetectedFrame, Observations, TrackingConfig, open_tracker

METHODS: Mapping[str, str] = {"baseline": "baseline", "ours": "assignment"}
"""Each row's method, and the identity method that it stands for."""

MAX_DISTANCE_M = 80.0
MIN_VISIBLE_SHARE = 0.1
TRACK_IDS_PER_CAMERA = 1_000_000


class MergeRow(TypedDict):
    """What one method made of the tracks.

    ``pairs_*`` count pairs of tracks that the method put into one identity (right: of one object; wrong: not) and
    pairs of one object that it did not (missed; a pair that stands in one image is none). ``pair_precision`` and
    ``pair_recall`` are shares of these; ``overlapping`` are the same for pairs of two cameras that were seen at one
    time. ``identities_pure``: share of the identities whose tracks are all of one object; ``identities_whole``: share
    of the objects with tracks whose tracks are all in one identity. ``idf1`` is over all cameras. Shares of nothing
    are None.
    """

    method: str
    pair_precision: float | None
    pair_recall: float | None
    identities_pure: float | None
    identities_whole: float | None
    idf1: float | None
    pairs_right: int
    pairs_wrong: int
    pairs_missed: int
    overlapping_precision: float | None
    overlapping_recall: float | None
    identities: int


class MergeBenchmark(TypedDict):
    """What ``hindsight benchmark merges --json`` prints."""

    drive: str
    frames: int
    cameras: int
    objects: int
    tracks: int
    noise: float
    seed: int
    lidar: bool
    rows: list[MergeRow]


@dataclass(frozen=True, eq=False)
class TrackedScene:
    """A scene's made observations, tracked: ``frames`` for the identity step, and what is known of each track.

    ``object_of`` gives each track's object, NOTHING where most of its boxes lie on none.
    """

    scene: Scene
    made: list[dict[str, MadeFrame]]
    frames: list[MultiCameraFrame]
    object_of: dict[int, int]
    camera_of: dict[int, str]
    share_frame: SharedFrames
    frames_of: dict[int, frozenset[int]]
    rig: Rig
    class_groups: tuple[int, ...]


def benchmark_merges(
    scene: Scene,
    noise: Noise,
    *,
    tracking: TrackingConfig | None = None,
    identity: IdentityConfig | None = None,
) -> MergeBenchmark:
    """Make observations of ``scene``, track them once, and merge the tracks by each of METHODS."""
    tracked = track_scene(scene, noise, tracking or TrackingConfig())
    rows = [
        score_method(tracked, name, (identity or IdentityConfig()).with_method(method))
        for name, method in METHODS.items()
    ]
    return MergeBenchmark(
        drive=scene.name,
        frames=len(scene.timestamp_ns),
        cameras=len(scene.cameras),
        objects=len(set(tracked.object_of.values()) - {NOTHING}),
        tracks=len(tracked.object_of),
        noise=noise.level,
        seed=noise.seed,
        lidar=noise.lidar,
        rows=rows,
    )


def track_scene(scene: Scene, noise: Noise, config: TrackingConfig) -> TrackedScene:
    """Make observations and track them in each camera."""
    groups = tuple(suppression_group_of(CLASS_NAMES).tolist())
    poses = Poses(scene.timestamp_ns, scene.city_SE3_ego)
    made = list(make_frames(scene, noise))
    views: list[dict[str, CameraView]] = [{} for _ in made]
    votes: dict[int, Counter[int]] = {}
    frames_of: dict[int, set[int]] = {}
    camera_of: dict[int, str] = {}
    shared = SharedFrames()
    for number, camera in enumerate(scene.cameras, start=1):
        looking = [frame[camera.name] for frame in made if camera.name in frame]
        times_ns = [one.timestamp_ns for one in looking]
        motion = motion_over(camera, poses, times_ns, CLASS_NAMES, config)
        tracker = open_tracker(config, class_groups=groups, motion=motion)
        detected = (DetectedFrame(one.frame_index, one.timestamp_ns, one.detections) for one in looking)
        tracks = tracker.track(detected, first_track_id=number * TRACK_IDS_PER_CAMERA + 1)
        for one, seen in zip(looking, tracks, strict=True):
            views[one.frame_index][camera.name] = CameraView(seen, one.boxes_3d, one.positions)
            shared.add(camera.name, seen.track_id.tolist())
            for track, detection in zip(seen.track_id.tolist(), seen.detection_index.tolist(), strict=True):
                owner = int(one.object_id[detection]) if detection >= 0 else NOTHING
                votes.setdefault(track, Counter())[owner] += detection >= 0
                frames_of.setdefault(track, set()).add(one.frame_index)
                camera_of[track] = camera.name
    return TrackedScene(
        scene=scene,
        made=made,
        frames=[MultiCameraFrame(index, of_frame) for index, of_frame in enumerate(views)],
        object_of={track: of_track.most_common(1)[0][0] for track, of_track in votes.items()},
        camera_of=camera_of,
        share_frame=shared,
        frames_of={track: frozenset(seen) for track, seen in frames_of.items()},
        rig=Rig.of(scene.cameras, scene.timestamp_ns, scene.city_SE3_ego),
        class_groups=groups,
    )


def score_method(tracked: TrackedScene, name: str, config: IdentityConfig) -> MergeRow:
    """Merge the tracks by one method and compare the identities with the truth."""
    merges = find_merges(tracked.frames, config, class_groups=tracked.class_groups, rig=tracked.rig)
    identity_of = {track: merges.identity_of.get(track, track) for track in tracked.object_of}
    pairs = PairCounts.of(tracked, identity_of)
    overlapping = PairCounts.of(tracked, identity_of, overlapping=True)
    tracks_of = _grouped(identity_of)
    pure = sum(len({tracked.object_of[track] for track in tracks}) == 1 for tracks in tracks_of.values())
    of_object = _grouped(tracked.object_of)
    of_object.pop(NOTHING, None)
    whole = sum(len({identity_of[track] for track in tracks}) == 1 for tracks in of_object.values())
    return MergeRow(
        method=name,
        pair_precision=pairs.precision,
        pair_recall=pairs.recall,
        identities_pure=_share(pure, len(tracks_of)),
        identities_whole=_share(whole, len(of_object)),
        idf1=_rounded(idf1(_tracking_rows(tracked, identity_of))),
        pairs_right=pairs.right,
        pairs_wrong=pairs.wrong,
        pairs_missed=pairs.missed,
        overlapping_precision=overlapping.precision,
        overlapping_recall=overlapping.recall,
        identities=len(tracks_of),
    )


@dataclass(frozen=True)
class PairCounts:
    """Pairs of tracks put together rightly, wrongly, and not though they ought to be."""

    right: int
    wrong: int
    missed: int

    @property
    def precision(self) -> float | None:
        return _share(self.right, self.right + self.wrong)

    @property
    def recall(self) -> float | None:
        return _share(self.right, self.right + self.missed)

    @staticmethod
    def of(tracked: TrackedScene, identity_of: Mapping[int, int], *, overlapping: bool = False) -> PairCounts:
        """All pairs that share no image; with ``overlapping`` those of two cameras that share a frame."""

        def counts(a: int, b: int) -> bool:
            if tracked.camera_of[a] == tracked.camera_of[b]:
                return not overlapping and not tracked.share_frame(a, b)
            return not overlapping or bool(tracked.frames_of[a] & tracked.frames_of[b])

        object_of = tracked.object_of
        right = wrong = missed = 0
        for tracks in _grouped(identity_of).values():
            for a, b in combinations(tracks, 2):
                same = object_of[a] == object_of[b] != NOTHING
                right += same and counts(a, b)
                wrong += not same and counts(a, b)
        for number, tracks in _grouped(object_of).items():
            if number != NOTHING:
                missed += sum(identity_of[a] != identity_of[b] and counts(a, b) for a, b in combinations(tracks, 2))
        return PairCounts(right, wrong, missed)


def _tracking_rows(tracked: TrackedScene, identity_of: Mapping[int, int]) -> TrackingRows:
    """Every image's objects within 80 m that show at all, and all observations."""
    cameras = {camera.name: number for number, camera in enumerate(tracked.scene.cameras)}
    truth_image: list[NDArray[np.int64]] = []
    truth_id: list[NDArray[np.int32]] = []
    truth_px: list[NDArray[np.float64]] = []
    label_image: list[NDArray[np.int64]] = []
    label_id: list[NDArray[np.int32]] = []
    label_px: list[NDArray[np.float32]] = []
    for frame, camera, made, seen in _images(tracked):
        image = frame * len(cameras) + cameras[camera]
        counted = (made.truth.distance_m <= MAX_DISTANCE_M) & (made.truth.visible_share >= MIN_VISIBLE_SHARE)
        rows = np.flatnonzero(counted)
        truth_image.append(np.full(len(rows), image, np.int64))
        truth_id.append(tracked.scene.object_id[made.truth.row[rows]])
        truth_px.append(made.truth.xyxy_px[rows])
        ignored = set(tracked.scene.object_id[made.truth.row[~counted]].tolist())
        kept = np.array([index for index, owner in enumerate(_owners(made, seen)) if owner not in ignored], np.intp)
        label_image.append(np.full(len(kept), image, np.int64))
        label_id.append(np.array([identity_of[track] for track in seen.track_id[kept].tolist()], np.int32))
        label_px.append(seen.xyxy_px[kept])
    images = np.concatenate([np.zeros(0, np.int64), *truth_image])
    objects_px = np.concatenate([np.zeros((0, 4)), *truth_px])
    labels = np.concatenate([np.zeros(0, np.int64), *label_image])
    pairs = overlapping_pairs(labels, np.concatenate([np.zeros((0, 4)), *label_px]), images, objects_px)
    return TrackingRows(
        truth_image=images,
        truth_id=np.concatenate([np.zeros(0, np.int32), *truth_id]),
        label_image=labels,
        label_id=np.unique(np.concatenate([np.zeros(0, np.int32), *label_id]), return_inverse=True)[1].astype(np.int32),
        pair_truth=pairs.b,
        pair_label=pairs.a,
        pair_iou=pairs.iou,
    )


def _images(tracked: TrackedScene) -> Iterator[tuple[int, str, MadeFrame, Observations]]:
    for frame, made in zip(tracked.frames, tracked.made, strict=True):
        for camera, view in frame.views.items():
            yield frame.frame_index, camera, made[camera], view.observations


def _owners(made: MadeFrame, seen: Observations) -> list[int]:
    return [
        int(made.object_id[detection]) if detection >= 0 else NOTHING for detection in seen.detection_index.tolist()
    ]


def _grouped(group_of: Mapping[int, int]) -> dict[int, list[int]]:
    groups: dict[int, list[int]] = {}
    for item, group in group_of.items():
        groups.setdefault(group, []).append(item)
    return groups


def _share(part: int, whole: int) -> float | None:
    return _rounded(part / whole) if whole else None


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, 4)
