"""Two-stage association over arrays of tracks (BYTE): sure detections choose tracks first, weak ones continue the rest.

In each image all tracks are moved to the image's time at once. Sure detections are paired with the tracks by overlap;
then the weak ones with the tracks that are still without, and these must overlap more, because a weak detection is more
often something else. What is left of the sure detections begins new tracks. All rules are in seconds, so any frame rate
will do and a gap in the frames is time that passes. Source: Zhang et al., ByteTrack, ECCV 2022.

The state of all tracks is a few arrays, so the cost of an image hardly grows with the number of its tracks.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import count

import numpy as np
from numpy.typing import NDArray

from labeler.tracking.box_filters import BoxFilters
from labeler.tracking.config import TrackingConfig
from labeler.tracking.frames import NS_PER_S, check_order, groups_of, sound_rows
from labeler.tracking.pairing import Candidates, overlapping, pair_off
from labeler.tracking.types import DetectedFrame, Observations

_Rows = NDArray[np.intp]


class TwoStageTracker:
    """Follows objects through the images of one camera; see the module for the method.

    ``class_groups[class_id]`` is a number; a track holds only classes of one number. ``rejected_count`` counts
    detections that could not be used: score or box not finite, or a box without area.
    """

    def __init__(self, config: TrackingConfig, *, class_groups: Sequence[int]) -> None:
        self._config = config
        self._class_groups = np.asarray(class_groups, np.int64)
        self._one_group = len(np.unique(self._class_groups)) <= 1
        self.rejected_count = 0

    def track(self, frames: Iterable[DetectedFrame], *, first_track_id: int) -> Iterator[Observations]:
        """One Observations for each frame, also where it is empty, rows by ``detection_index``.

        Only live tracks are held in memory. Raises TrackingError where frames come out of order (equal timestamps are
        taken as no time passing) or a class id has no group.
        """
        live = LiveTracks(self._config, count(first_track_id))
        previous: DetectedFrame | None = None
        for frame in frames:
            check_order(previous, frame)
            sound = sound_rows(frame.detections)
            self.rejected_count += len(frame.detections) - len(sound)
            rows = sound[frame.detections.score[sound] >= self._config.min_score]
            group = groups_of(frame, rows, self._class_groups)
            boxes = frame.detections.xyxy_px[rows].astype(np.float64)
            live.move_to(frame.timestamp_ns)
            track_id = live.feed(boxes, frame.detections.score[rows], group)
            fed = track_id >= 0
            yield _observations(frame, rows[fed], track_id[fed])
            previous = frame


class LiveTracks:
    """The tracks that have not ended, as arrays over rows. ``new_ids`` names those that begin."""

    def __init__(self, config: TrackingConfig, new_ids: Iterator[int]) -> None:
        self._config = config
        self._new_ids = new_ids
        self._now_ns = 0
        self._max_coast_ns = round(config.max_coast_s * NS_PER_S)
        self.filters = BoxFilters(config)
        self.track_id = np.zeros(0, np.int32)
        self.group = np.zeros(0, np.int64)
        self.last_seen_ns = np.zeros(0, np.int64)

    def move_to(self, timestamp_ns: int) -> None:
        """End the tracks that have not been seen for too long, and predict where the others are."""
        staying = self.last_seen_ns >= timestamp_ns - self._max_coast_ns
        if not staying.all():
            self.filters.keep(staying)
            self.track_id, self.group = self.track_id[staying], self.group[staying]
            self.last_seen_ns = self.last_seen_ns[staying]
        if len(self.track_id):
            self.filters.predict((timestamp_ns - self._now_ns) / NS_PER_S)
        self._now_ns = timestamp_ns

    def feed(
        self, xyxy_px: NDArray[np.float64], score: NDArray[np.float32], group: NDArray[np.int64]
    ) -> NDArray[np.int32]:
        """(N,) the track of each detection of the present moment, old or new; -1 for those that feed none."""
        track_id = np.full(len(score), -1, np.int32)
        sure = score >= self._config.sure_score
        if len(self.track_id) and len(score):
            tracks, rows = self._pair(xyxy_px, sure, group)
            self.filters.update(tracks, xyxy_px[rows])
            self.last_seen_ns[tracks] = self._now_ns
            track_id[rows] = self.track_id[tracks]
        born = np.flatnonzero(sure & (track_id < 0))
        if len(born):
            track_id[born] = self._begin(xyxy_px[born], group[born])
        return track_id

    def _pair(
        self, xyxy_px: NDArray[np.float64], sure: NDArray[np.bool_], group: NDArray[np.int64]
    ) -> tuple[_Rows, _Rows]:
        """Rows of tracks and rows of detections that belong together."""
        corners = np.ascontiguousarray(xyxy_px.T)
        least = np.where(sure, self._config.min_iou_sure, self._config.min_iou_weak)
        near = overlapping(*self.filters.corners_px(), corners[:2], corners[2:], min_iou=least.min())
        near = near[(self.group[near.a] == group[near.b]) & (near.weight >= least[near.b])]
        is_sure = sure[near.b]
        if is_sure.all():
            return self._pair_off(near, len(sure))
        tracks, rows = self._pair_off(near[is_sure], len(sure))
        waiting = np.ones(len(self.track_id), np.bool_)
        waiting[tracks] = False
        weak_tracks, weak_rows = self._pair_off(near[waiting[near.a] & ~is_sure], len(sure))
        return np.concatenate([tracks, weak_tracks]), np.concatenate([rows, weak_rows])

    def _pair_off(self, candidates: Candidates, detection_count: int) -> tuple[_Rows, _Rows]:
        return pair_off(candidates, a_count=len(self.track_id), b_count=detection_count)

    def _begin(self, xyxy_px: NDArray[np.float64], group: NDArray[np.int64]) -> NDArray[np.int32]:
        track_id = np.fromiter(self._new_ids, np.int32, count=len(group))
        self.filters.add(xyxy_px)
        self.track_id = np.concatenate([self.track_id, track_id])
        self.group = np.concatenate([self.group, group])
        self.last_seen_ns = np.concatenate([self.last_seen_ns, np.full(len(group), self._now_ns, np.int64)])
        return track_id


def _observations(frame: DetectedFrame, rows: _Rows, track_id: NDArray[np.int32]) -> Observations:
    detections = frame.detections
    return Observations(
        track_id=track_id,
        frame_index=np.full(len(rows), frame.frame_index, np.int32),
        xyxy_px=detections.xyxy_px[rows],
        score=detections.score[rows],
        class_id=detections.class_id[rows],
        detection_index=rows.astype(np.int32),
    )
