"""What is kept of each track: a bounded summary, however long it is.

While a track lives, its places wait in a buffer; when it has ended, they are smoothed, together with those of other
ended tracks, and only the states at both ends and a few nodes between them stay.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from labeler.geometry.se3 import transform_points
from labeler.identity.places import Places
from labeler.identity.smoothing import Measured, MotionConfig, Trajectory, smooth

MAX_NODES = 48
_MAX_WAITING_PLACES = 512
_KEPT_AT_ENDS = 128
_ENDED_AFTER_S = 4.0
_TRACKS_AT_ONCE = 128


@dataclass(frozen=True, eq=False)
class TrackEnd:
    """The state of a track at its first or last place: ``mean`` (4,) x, y and speeds in the city frame, ``cov`` (4, 4);
    ``edge`` whether the box touches the left or the right edge of the image there."""

    frame_index: int
    time_s: float
    mean: NDArray[np.float64]
    cov: NDArray[np.float64]
    edge: bool


@dataclass(eq=False)
class TrackRecord:
    """One track. ``class_votes`` are sums of scores by class; ``log_size_sum`` (3,) over ``size_count`` 3D boxes;
    ``nodes`` (K, 7) rows of frame, time, x, y, speed x, speed y and standard deviation, in the city frame; ``colours``
    its histogram (see :mod:`labeler.identity.colours`), None where that is not known."""

    track_id: int
    camera: int
    group: int
    first_frame: int
    last_frame: int
    count: int = 0
    score_sum: float = 0.0
    best_score: float = 0.0
    class_votes: dict[int, float] = field(default_factory=dict[int, float])
    size_count: int = 0
    log_size_sum: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    begin: TrackEnd | None = None
    end: TrackEnd | None = None
    nodes: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 7)))
    first_edge: bool = False
    last_edge: bool = False
    colours: NDArray[np.float32] | None = None

    @property
    def mean_score(self) -> float:
        """Of its observations; those that the tracker filled in count as 0."""
        return self.score_sum / max(1, self.count)

    @property
    def size_m(self) -> NDArray[np.float64] | None:
        """(3,) geometric mean of length, width and height, None without a 3D box."""
        return np.exp(self.log_size_sum / self.size_count) if self.size_count else None

    def class_agreement(self, other: TrackRecord) -> float:
        """1 where both were always taken for the same class, 0 where never."""
        mine, theirs = sum(self.class_votes.values()), sum(other.class_votes.values())
        if mine <= 0 or theirs <= 0:
            return 0.5
        return sum(
            min(votes / mine, other.class_votes.get(class_id, 0.0) / theirs)
            for class_id, votes in self.class_votes.items()
        )


class TrackBook:
    """The records of all tracks; filled frame by frame, then closed."""

    def __init__(self, motion: MotionConfig) -> None:
        self.records: dict[int, TrackRecord] = {}
        self._motion = motion
        self._live: dict[int, list[NDArray[np.float64]]] = {}
        self._last_place_s: dict[int, float] = {}
        self._ended: list[tuple[int, Measured]] = []

    def add(self, places: Places, time_s: float, city_SE3_ego: NDArray[np.float64]) -> None:
        """Take in the observations of one frame."""
        city_xy_m = transform_points(city_SE3_ego, np.nan_to_num(places.xyz_m))[:, :2]
        turn = city_SE3_ego[:2, :2]
        city_cov_m2 = turn @ places.cov_m2 @ turn.T
        has_place, has_box = places.has_place.tolist(), places.has_box.tolist()
        edge = places.at_edge.tolist()
        log_size = np.log(np.maximum(np.nan_to_num(places.size_m, nan=1.0), 0.05))
        for row, track in enumerate(places.track.tolist()):
            record = self._see(places, row, track, edge[row])
            if has_box[row] and not edge[row]:
                record.size_count += 1
                record.log_size_sum += log_size[row]
            if has_place[row]:
                place = np.array([places.frame_index, time_s, *city_xy_m[row], *city_cov_m2[row].ravel()])
                self._live.setdefault(track, []).append(place)
                self._last_place_s[track] = time_s
        self._end_those_unseen(time_s)

    def close(self, colours: Mapping[int, NDArray[np.float32]]) -> None:
        """End all tracks, smooth what waits, and give each its colours."""
        for track in list(self._live):
            self._end(track)
        self._smooth_ended()
        for track, record in self.records.items():
            record.colours = colours.get(track)

    def _see(self, places: Places, row: int, track: int, edge: bool) -> TrackRecord:
        record = self.records.get(track)
        if record is None:
            frame = places.frame_index
            record = TrackRecord(track, int(places.camera[row]), int(places.group[row]), frame, frame, first_edge=edge)
            self.records[track] = record
        score, class_id = float(places.score[row]), int(places.class_id[row])
        record.last_frame, record.last_edge = places.frame_index, edge
        record.count += 1
        record.score_sum += score
        record.best_score = max(record.best_score, score)
        record.class_votes[class_id] = record.class_votes.get(class_id, 0.0) + score
        return record

    def _end_those_unseen(self, now_s: float) -> None:
        for track in [track for track in self._live if now_s - self._last_place_s[track] > _ENDED_AFTER_S]:
            self._end(track)
        for track, waiting in self._live.items():
            if len(waiting) > _MAX_WAITING_PLACES:
                self._live[track] = (
                    waiting[:_KEPT_AT_ENDS] + waiting[_KEPT_AT_ENDS:-_KEPT_AT_ENDS:2] + waiting[-_KEPT_AT_ENDS:]
                )
        if len(self._ended) >= _TRACKS_AT_ONCE:
            self._smooth_ended()

    def _end(self, track: int) -> None:
        rows = np.stack(self._live.pop(track))
        measured = Measured(rows[:, 0].astype(np.int64), rows[:, 1], rows[:, 2:4], rows[:, 4:].reshape(-1, 2, 2))
        self._ended.append((track, measured))

    def _smooth_ended(self) -> None:
        trajectories = smooth([measured for _, measured in self._ended], self._motion)
        for (track, _), trajectory in zip(self._ended, trajectories, strict=True):
            self._keep(self.records[track], trajectory)
        self._ended.clear()

    def _keep(self, record: TrackRecord, trajectory: Trajectory) -> None:
        """A track that was silent for long comes in several pieces, in order of time."""
        if record.begin is None:
            record.begin = _end_state(trajectory, 0, edge=record.first_edge)
        record.end = _end_state(trajectory, -1, edge=record.last_edge)
        rows = np.unique(np.linspace(0, len(trajectory) - 1, min(len(trajectory), MAX_NODES)).round().astype(int))
        std_m = np.sqrt(trajectory.cov[rows, 0, 0] + trajectory.cov[rows, 1, 1])
        frames = trajectory.frame_index[rows].astype(np.float64)
        nodes = np.column_stack([frames, trajectory.time_s[rows], trajectory.mean[rows], std_m])
        both = np.concatenate([record.nodes, nodes])
        keep = np.unique(np.linspace(0, len(both) - 1, min(len(both), MAX_NODES)).round().astype(int))
        record.nodes = both[keep]


def _end_state(trajectory: Trajectory, row: int, *, edge: bool) -> TrackEnd:
    return TrackEnd(
        int(trajectory.frame_index[row]), float(trajectory.time_s[row]), trajectory.mean[row], trajectory.cov[row], edge
    )
