"""What Algorithm 2 needs to know about pairs of tracks, gathered in one pass: memory grows with tracks and pairs, not
frames.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from labeler.identity.config import Algorithm2Config
from labeler.identity.linking import SharedFrames
from labeler.identity.overlap import BoxPair, boxes_at_same_place
from labeler.identity.types import CameraView, MultiCameraFrame, SharedFrame
from labeler.lidar.types import Boxes3D
from labeler.tracking.types import NO_DETECTION


@dataclass
class PairEvidence:
    """Sums over the frames in which two tracks have boxes at the same place, and the best of these frames."""

    agreeing_frames: int = 0
    similarity_sum: float = 0.0
    distance_sum_m: float = 0.0
    bev_iou_sum: float = 0.0
    best: list[tuple[float, SharedFrame]] = field(default_factory=list[tuple[float, SharedFrame]])

    def add(self, frame_index: int, pair: BoxPair, best_frames: int) -> None:
        """Count one more frame."""
        self.agreeing_frames += 1
        self.similarity_sum += pair.similarity
        self.distance_sum_m += pair.distance_m
        self.bev_iou_sum += pair.bev_iou
        self.best.append((pair.similarity, SharedFrame(frame_index, pair.distance_m, pair.bev_iou, pair.iou_3d)))
        self.best.sort(key=lambda entry: (-entry[0], entry[1].frame_index))
        del self.best[best_frames:]


@dataclass(frozen=True, eq=False)
class _TrackedBoxes:
    """The 3D boxes of one camera that belong to a track: ``boxes`` (N), ``track`` and ``group`` (N,)."""

    boxes: Boxes3D
    track: NDArray[np.int32]
    group: NDArray[np.int64]


class Evidence:
    """Everything that the decision needs to know about the tracks of a drive; filled frame by frame."""

    def __init__(self, config: Algorithm2Config, class_groups: Sequence[int]) -> None:
        self.cameras: dict[int, str] = {}
        self.shared_frames = SharedFrames()
        self.pairs: dict[tuple[int, int], PairEvidence] = {}
        self._frames_with_both: dict[tuple[int, int], int] = {}
        self._group_scores: dict[int, dict[int, float]] = {}
        self._config = config
        self._class_groups = np.asarray(class_groups, np.int64)

    def add(self, frame: MultiCameraFrame) -> None:
        """Take one frame in."""
        tracked: list[_TrackedBoxes] = []
        for camera in sorted(frame.views):
            view = frame.views[camera]
            self._see_tracks(camera, view)
            tracked.append(self._boxes_of_tracks(view))
        for a, b in combinations(tracked, 2):
            self._compare(frame.frame_index, a, b)

    def frames_with_both(self, track_a: int, track_b: int) -> int:
        """In how many frames both tracks have a 3D box."""
        return self._frames_with_both.get((min(track_a, track_b), max(track_a, track_b)), 0)

    def group_of(self, track: int) -> int:
        """The class group for which a track's observations speak most, by the sum of their scores."""
        scores = self._group_scores[track]
        return min(scores, key=lambda group: (-scores[group], group))

    def _see_tracks(self, camera: str, view: CameraView) -> None:
        observations = view.observations
        tracks = observations.track_id.tolist()
        scores = np.nan_to_num(observations.score).tolist()
        for track, group, score in zip(tracks, self._group(observations.class_id).tolist(), scores, strict=True):
            self.cameras.setdefault(track, camera)
            by_group = self._group_scores.setdefault(track, {})
            by_group[group] = by_group.get(group, 0.0) + score
        self.shared_frames.add(camera, tracks)

    def _boxes_of_tracks(self, view: CameraView) -> _TrackedBoxes:
        """A 3D box belongs to the 2D observation of the detection that painted its points."""
        observations, boxes = view.observations, view.boxes_3d
        fed = np.flatnonzero(observations.detection_index != NO_DETECTION)
        row_of_detection = dict(zip(observations.detection_index[fed].tolist(), fed.tolist(), strict=True))
        rows = [row_of_detection.get(detection, -1) for detection in boxes.detection_index.tolist()]
        observation = np.array(rows, np.intp)
        with_track = np.flatnonzero(observation >= 0)
        observation = observation[with_track]
        return _TrackedBoxes(
            boxes[with_track], observations.track_id[observation], self._group(observations.class_id[observation])
        )

    def _compare(self, frame_index: int, a: _TrackedBoxes, b: _TrackedBoxes) -> None:
        for track_a in a.track.tolist():
            for track_b in b.track.tolist():
                key = (min(track_a, track_b), max(track_a, track_b))
                self._frames_with_both[key] = self._frames_with_both.get(key, 0) + 1
        allowed = a.group[:, None] == b.group[None, :]
        for pair in boxes_at_same_place(a.boxes, b.boxes, allowed, self._config.min_similarity):
            track_a, track_b = int(a.track[pair.a]), int(b.track[pair.b])
            key = (min(track_a, track_b), max(track_a, track_b))
            self.pairs.setdefault(key, PairEvidence()).add(frame_index, pair, self._config.best_frames)

    def _group(self, class_id: NDArray[np.int16]) -> NDArray[np.int64]:
        unknown = class_id[(class_id < 0) | (class_id >= len(self._class_groups))]
        if len(unknown):
            raise ValueError(
                f"an observation has class {unknown[0]}, but class_groups holds {len(self._class_groups)} classes; "
                "give it a group for every class of the detector"
            )
        return self._class_groups[class_id]
