"""Two-stage association over arrays of tracks (BYTE): sure detections choose tracks first, weak ones continue the rest.

In each image all tracks are moved to the image's time at once. Sure detections are paired with the tracks by overlap;
then the weak ones with the tracks that are still without, and these must overlap more, because a weak detection is more
often something else. What is left of the sure detections begins new tracks. All rules are in seconds, so any frame rate
will do and a gap in the frames is time that passes. Source: Zhang et al., ByteTrack, ECCV 2022.

The state of all tracks is a few arrays, so the cost of an image hardly grows with the number of its tracks.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import count

import numpy as np
from numpy.typing import NDArray

from labeler.tracking.box_filters import POSITION, BoxFilters
from labeler.tracking.camera_motion import CameraMotion
from labeler.tracking.config import TrackingConfig
from labeler.tracking.frames import NS_PER_S, Usable, with_usable_detections
from labeler.tracking.pairing import overlapping, pair_in_turn
from labeler.tracking.types import DetectedFrame, Observations

_Rows = NDArray[np.intp]

_TRACK_ID, _CLASS_ID, _GROUP, _LAST_SEEN_NS, _IS_WEAK = range(5)
_FACTS = 5
"""What is known of each live track besides its motion, a row each of one array: columns come and go together."""


class TwoStageTracker:
    """Follows objects through the images of one camera; see the module for the method.

    ``class_groups[class_id]`` is a number; a track holds only classes of one number. ``motion`` is the camera's, where
    it is known. ``rejected_count`` counts detections that could not be used: score or box not finite, or a box without
    area.
    """

    def __init__(
        self, config: TrackingConfig, *, class_groups: Sequence[int], motion: CameraMotion | None = None
    ) -> None:
        self._config = config
        self._motion = motion
        self._class_groups = np.asarray(class_groups, np.int64)
        self.rejected_count = 0

    def track(self, frames: Iterable[DetectedFrame], *, first_track_id: int) -> Iterator[Observations]:
        """One Observations for each frame, also where it is empty, rows by ``detection_index``.

        Only live tracks and some frames are held in memory. Raises TrackingError where frames come out of order (equal
        timestamps are taken as no time passing) or a class id has no group.
        """
        live = LiveTracks(self._config, count(first_track_id), motion=self._motion)
        for frame, usable in with_usable_detections(
            frames, min_score=self._config.min_score, class_groups=self._class_groups
        ):
            self.rejected_count += usable.broken_count
            live.move_to(frame.timestamp_ns)
            track_id, _ = live.feed(usable)
            fed = track_id >= 0
            yield _observations(frame, usable.rows[fed], track_id[fed])


class LiveTracks:
    """The tracks that have not ended, as arrays over columns. ``new_ids`` names those that begin; where the camera's
    ``motion`` is known, boxes are predicted by it.

    With ``weak_score``, what is left over forms tracks of its own, which a detection of at least that score begins.
    They never take a detection from the others, nor one that is sure.
    """

    def __init__(
        self,
        config: TrackingConfig,
        new_ids: Iterator[int],
        *,
        weak_score: float = math.inf,
        motion: CameraMotion | None = None,
    ) -> None:
        self._config = config
        self._new_ids = new_ids
        self._weak_score = weak_score
        self._motion = motion
        self._now_ns = 0
        self._max_coast_ns = round(config.max_coast_s * NS_PER_S)
        self._filters = BoxFilters(config)
        self._known = np.zeros((_FACTS, 0), np.int64)

    def move_to(self, timestamp_ns: int) -> None:
        """End the tracks that have not been seen for too long, and predict where the others are."""
        staying = self._known[_LAST_SEEN_NS] >= timestamp_ns - self._max_coast_ns
        if not staying.all():
            self._filters.keep(staying)
            self._known = self._known.compress(staying, axis=1)
        if len(self._filters):
            if self._motion is not None:
                step = self._motion.step(self._now_ns, timestamp_ns)
                height_m = self._motion.usual_height_m[self._known[_CLASS_ID]]
                self._filters.move(step.displacements(self._filters.state[POSITION], height_m))
            self._filters.predict((timestamp_ns - self._now_ns) / NS_PER_S)
        self._now_ns = timestamp_ns

    def feed(self, found: Usable) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
        """(N,) the track of each detection of the present moment, old or new, -1 for those that feed none; and (N,)
        whether it is left over: in no track, or in a weak one."""
        _, xyxy_px, score, class_id, group, _ = found
        sure = score >= self._config.sure_score
        may_begin = sure | (score >= self._weak_score)
        column = np.full(len(score), -1, np.intp)
        if len(self._filters) and len(score):
            columns, rows = self._pair(xyxy_px, sure, may_begin, group)
            self._filters.update(columns, self._filters.measure(xyxy_px[rows]))
            self._known[_LAST_SEEN_NS, columns] = self._now_ns
            column[rows] = columns
        born = np.flatnonzero(may_begin & (column < 0))
        if len(born):
            born = born[np.argsort(~sure[born], kind="stable")]  # sure ones are numbered first
            column[born] = len(self._filters) + np.arange(len(born))
            self._begin(xyxy_px[born], class_id[born], group[born], ~sure[born])
        fed = column >= 0
        track_id, left_over = np.full(len(score), -1, np.int32), np.ones(len(score), np.bool_)
        track_id[fed] = self._known[_TRACK_ID, column[fed]]
        left_over[fed] = self._known[_IS_WEAK, column[fed]] == 1
        return track_id, left_over

    def _pair(
        self,
        xyxy_px: NDArray[np.float64],
        sure: NDArray[np.bool_],
        may_begin: NDArray[np.bool_],
        group: NDArray[np.int64],
    ) -> tuple[_Rows, _Rows]:
        """Columns of tracks and rows of detections that belong together."""
        least_sure, least_weak = self._config.min_iou_sure, self._config.min_iou_weak
        corners = np.ascontiguousarray(xyxy_px.T)
        near = overlapping(*self._filters.corners_px(), corners[:2], corners[2:], min_iou=min(least_sure, least_weak))
        of_weak = self._known[_IS_WEAK, near.a]
        firm = np.where(of_weak, may_begin[near.b], sure[near.b])
        fits = near.weight >= np.where(firm, least_sure, least_weak)
        fits &= (of_weak == 0) | ~sure[near.b]
        fits &= self._known[_GROUP, near.a] == group[near.b]
        turn = 2 * of_weak + ~firm  # sure tracks before weak ones; in each, firm detections before the others
        return pair_in_turn(near[fits], turn[fits], a_count=len(self._filters), b_count=len(sure))

    def _begin(
        self,
        xyxy_px: NDArray[np.float64],
        class_id: NDArray[np.int16],
        group: NDArray[np.int64],
        weak: NDArray[np.bool_],
    ) -> None:
        new = np.empty((_FACTS, len(group)), np.int64)
        new[_TRACK_ID] = np.fromiter(self._new_ids, np.int64, count=len(group))
        new[_CLASS_ID], new[_GROUP] = class_id, group
        new[_LAST_SEEN_NS], new[_IS_WEAK] = self._now_ns, weak
        self._known = np.concatenate([self._known, new], axis=1)
        self._filters.add(self._filters.measure(xyxy_px))


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
