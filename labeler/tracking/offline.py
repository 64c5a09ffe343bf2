"""Tracking in a recording: what comes later is known, so each track is mended by it before it is given out.

Forward, sure detections begin tracks and weak ones continue them (:mod:`labeler.tracking.two_stage`); what is left
over may form weak tracks of its own, which never take a detection from a sure one. Then, over a window of frames: sure
tracks are followed back from their beginning, fragments of one object are stitched, each track is smoothed, short gaps
are filled, boxes are refined by the smooth path, and each box is judged (:mod:`labeler.tracking.trust`).

A window reaches over ``look_ahead_s`` of the future and as much of the past of the frames that are given out, so memory
does not grow with the length of the drive. What was decided about a track holds for the windows that follow.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import count, pairwise

import numpy as np
from numpy.typing import NDArray

from labeler.tracking.camera_motion import CameraMotion, TracksMotion
from labeler.tracking.config import TrackingConfig
from labeler.tracking.doubles import SeenBoxes, are_doubles
from labeler.tracking.extension import extend_back
from labeler.tracking.frames import NS_PER_S, with_usable_detections
from labeler.tracking.smoothing import Paths, TrackBoxes, smooth
from labeler.tracking.stitching import find_continuations, overlap_of_rows
from labeler.tracking.trust import JudgedBoxes, features_of, trust_of
from labeler.tracking.two_stage import LiveTracks
from labeler.tracking.types import NO_DETECTION, DetectedFrame, Observations
from labeler.tracking.window import NO_TRACK, TrackedFrame, Window

Judge = Callable[[NDArray[np.float64]], NDArray[np.float64]]

_FRAMES_AT_ONCE = 400
"""Frames that are given out together: more would wait for no better answer, fewer would do more twice."""

_LEAST_SCORE = 0.05
_NOISE_POWER = 4
_MOST_NOISE = 1000.0


class OfflineTracker:
    """Follows objects through the recorded images of one camera; see the module for the method.

    ``class_groups[class_id]`` is a number; a track holds only classes of one number. ``rejected_count`` counts
    detections that could not be used: score or box not finite, or a box without area. ``judge`` gives the trust (N,)
    of boxes from their features (N, F), see :mod:`labeler.tracking.trust`. ``motion`` is the camera's, where it is
    known.
    """

    def __init__(
        self,
        config: TrackingConfig,
        *,
        class_groups: Sequence[int],
        motion: CameraMotion | None = None,
        judge: Judge = trust_of,
    ) -> None:
        self._config = config
        self._motion = motion
        self._class_groups = np.asarray(class_groups, np.int64)
        self._judge = judge
        self.rejected_count = 0

    def track(self, frames: Iterable[DetectedFrame], *, first_track_id: int) -> Iterator[Observations]:
        """One Observations for each frame, also where it is empty: rows by ``detection_index``, then those that were
        filled in.

        Raises TrackingError where frames come out of order (equal timestamps are taken as no time passing) or a class
        id has no group.
        """
        mending = _Mending(self._config, self._judge, self._motion)
        for frame in self._track_forward(frames, first_track_id):
            mending.add(frame)
            while mending.is_ready():
                yield from mending.give_out(_FRAMES_AT_ONCE)
        yield from mending.give_out(mending.waiting)

    def _track_forward(self, frames: Iterable[DetectedFrame], first_track_id: int) -> Iterator[TrackedFrame]:
        new_ids = count(first_track_id)
        live = LiveTracks(self._config, new_ids, weak_score=self._config.birth_score, motion=self._motion)
        for frame, usable in with_usable_detections(
            frames, min_score=self._config.min_score, class_groups=self._class_groups
        ):
            self.rejected_count += usable.broken_count
            live.move_to(frame.timestamp_ns)
            track_id, is_weak = live.feed(usable)
            yield TrackedFrame(frame, usable, track_id, is_weak)


class _Mending:
    """The window: frames that were given out and are still looked at, and those that wait."""

    def __init__(self, config: TrackingConfig, judge: Judge, motion: CameraMotion | None) -> None:
        self._config = config
        self._motion = motion
        self._judge = judge
        self._look_ns = round(config.look_ahead_s * NS_PER_S)
        self._frames: list[TrackedFrame] = []
        self._given_out = 0
        self._renamed: dict[int, int] = {}

    def add(self, frame: TrackedFrame) -> None:
        self._frames.append(frame)

    @property
    def waiting(self) -> int:
        return len(self._frames) - self._given_out

    def is_ready(self) -> bool:
        """Whether as many frames as are given out together wait, and enough of their future is known."""
        if self.waiting <= _FRAMES_AT_ONCE:
            return False
        last = self._frames[self._given_out + _FRAMES_AT_ONCE - 1].frame
        known_ns = self._frames[-1].frame.timestamp_ns - last.timestamp_ns
        return known_ns >= self._look_ns or self.waiting >= 4 * _FRAMES_AT_ONCE

    def give_out(self, frame_count: int) -> Iterator[Observations]:
        """Mend the window, and give out the frames that have waited longest."""
        if frame_count == 0:
            return
        mended = self._mend(Window.of(self._frames), self._given_out)
        stop = self._given_out + frame_count
        for begin, end in pairwise(mended.start[self._given_out : stop + 1].tolist()):
            yield mended.observations[begin:end]
        self._given_out = stop
        self._forget()

    def _mend(self, window: Window, first_frame: int) -> _Mended:
        """The passes, in order. Frames before ``first_frame`` were given out: no detection there changes its track."""
        config = self._config
        camera = None if self._motion is None else self._motion.at(window.timestamp_ns)
        window = window.with_tracks(self._current_ids(window.track_id))
        tracks = _Tracks.of(window)
        motion = tracks.moved_by(camera)
        paths = smooth(tracks.boxes, window.time_s, config, motion)
        if config.follow_back:
            window = self._followed_back(window, tracks, paths, first_frame, motion)
            tracks = _Tracks.of(window)
            motion = tracks.moved_by(camera)
            paths = smooth(tracks.boxes, window.time_s, config, motion)
        before = find_continuations(paths, tracks.group, tracks.are_sure(window), window.time_s, config, motion)
        joined = np.flatnonzero(before != np.arange(len(before)))
        if len(joined):
            self._renamed.update(zip(tracks.ids[joined].tolist(), tracks.ids[before[joined]].tolist(), strict=True))
            window = window.with_tracks(self._current_ids(window.track_id))
            tracks, paths = _joined(tracks, paths, before, window, config, camera)
        return _Mended.of(window, tracks, paths, config, self._judge)

    def _followed_back(
        self, window: Window, tracks: _Tracks, paths: Paths, first_frame: int, motion: TracksMotion | None
    ) -> Window:
        """Only sure tracks are followed; they may take what is left over and what weak tracks have."""
        sure = tracks.are_sure(window)
        free = np.where(window.is_weak, np.int32(NO_TRACK), window.track_id)
        of_sure = paths[sure[paths.track]]
        rows, track = extend_back(
            window.with_tracks(free), of_sure, tracks.group, self._config, first_frame=first_frame, motion=motion
        )
        track_id = window.track_id.copy()
        track_id[rows] = tracks.ids[track]
        is_weak = window.is_weak.copy()
        is_weak[rows] = False
        return replace(window, track_id=track_id, is_weak=is_weak)

    def _current_ids(self, track_id: NDArray[np.int32]) -> NDArray[np.int32]:
        if not self._renamed:
            return track_id
        ids, inverse = np.unique(track_id, return_inverse=True)
        return np.array([self._renamed.get(one, one) for one in ids.tolist()], np.int32)[inverse]

    def _forget(self) -> None:
        """Drop frames that are too far in the past to matter, and names that no frame has any more."""
        if self._given_out == 0:
            return
        latest_ns = self._frames[self._given_out - 1].frame.timestamp_ns
        keep_from = max(0, self._given_out - _FRAMES_AT_ONCE)
        while keep_from < self._given_out and self._frames[keep_from].frame.timestamp_ns < latest_ns - self._look_ns:
            keep_from += 1
        del self._frames[:keep_from]
        self._given_out -= keep_from
        alive = set(np.unique(np.concatenate([frame.track_id for frame in self._frames])).tolist())
        self._renamed = {track: name for track, name in self._renamed.items() if track in alive}


@dataclass(frozen=True, eq=False)
class _Tracks:
    """The tracks of a window by number: ``ids`` (T,), ``group`` (T,), ``class_id`` (T,) of the surest box of each,
    their ``boxes``, and the ``rows`` (N,) of the window that these are."""

    ids: NDArray[np.int32]
    group: NDArray[np.int64]
    class_id: NDArray[np.int16]
    boxes: TrackBoxes
    rows: NDArray[np.intp]

    @staticmethod
    def of(window: Window) -> _Tracks:
        rows = np.flatnonzero(window.track_id != NO_TRACK)
        rows = rows[np.lexsort((-window.score[rows], window.frame[rows], window.track_id[rows]))]
        ids, first, track = np.unique(window.track_id[rows], return_index=True, return_inverse=True)
        best = np.zeros(len(ids))
        np.maximum.at(best, track, window.score[rows])
        score = window.score[rows]
        class_id = np.empty(len(ids), np.int16)
        is_best = np.flatnonzero(score == best[track])[::-1]
        class_id[track[is_best]] = window.class_id[rows[is_best]]  # of equals the first
        noise = (best[track] / np.maximum(window.score[rows], _LEAST_SCORE)) ** _NOISE_POWER
        boxes = TrackBoxes(
            track.astype(np.int64), window.frame[rows], window.xyxy_px[rows], np.clip(noise, 1.0, _MOST_NOISE)
        )
        return _Tracks(ids, window.group[rows][first], class_id, boxes, rows)

    def moved_by(self, camera: CameraMotion | None) -> TracksMotion | None:
        """What a camera does to these tracks, None where that is not known."""
        return None if camera is None else TracksMotion(camera, camera.usual_height_m[self.class_id])

    def are_sure(self, window: Window) -> NDArray[np.bool_]:
        """(T,) whether a track has a sure detection."""
        sure = np.zeros(len(self.ids), np.bool_)
        sure[self.boxes.track[~window.is_weak[self.rows]]] = True
        return sure


def _joined(
    apart: _Tracks,
    paths: Paths,
    before: NDArray[np.int64],
    window: Window,
    config: TrackingConfig,
    camera: CameraMotion | None,
) -> tuple[_Tracks, Paths]:
    """The tracks of a window whose fragments have one name, and their paths: only where fragments were joined, each
    ``before`` (T,) another, is there a new path to find."""
    tracks = _Tracks.of(window)
    has_changed = np.zeros(len(before), np.bool_)
    fragment = np.flatnonzero(before != np.arange(len(before)))
    has_changed[fragment] = has_changed[before[fragment]] = True
    number = np.searchsorted(tracks.ids, apart.ids)
    same = paths[~has_changed[paths.track]]
    is_new = np.zeros(len(tracks.ids), np.bool_)
    is_new[number[before[fragment]]] = True
    of_new = tracks.boxes[is_new[tracks.boxes.track]]
    again = smooth(of_new, window.time_s, config, tracks.moved_by(camera))
    return tracks, replace(same, track=number[same.track]).with_tracks_of(again)


@dataclass(frozen=True, eq=False)
class _Mended:
    """What the passes found, a row for each observation, by frame; ``start`` (F + 1,) is where each frame begins."""

    start: NDArray[np.intp]
    observations: Observations

    @staticmethod
    def of(window: Window, tracks: _Tracks, paths: Paths, config: TrackingConfig, judge: Judge) -> _Mended:
        steps = len(window.time_s) + 1
        at = np.searchsorted(paths.track * steps + paths.frame, tracks.boxes.track * steps + tracks.boxes.frame)
        seen = np.full(len(paths.track), NO_DETECTION, np.intp)
        seen[at] = tracks.rows
        boxes = paths.xyxy_px
        on_path = np.zeros(len(seen))
        on_path[at] = overlap_of_rows(boxes[at], tracks.boxes.xyxy_px)
        if not config.refine:
            boxes[at] = tracks.boxes.xyxy_px
        kept = (seen != NO_DETECTION) | _in_short_gap(seen, paths, window.time_s, config.max_gap_s)
        class_id = window.class_id[_last_seen(seen, seen != NO_DETECTION)]
        score = np.where(seen == NO_DETECTION, np.nan, window.score[seen])
        kept[kept] = ~are_doubles(
            SeenBoxes(paths.track[kept], paths.frame[kept], boxes[kept], score[kept], tracks.group), config
        )
        seen, track, frame, boxes = seen[kept], paths.track[kept], paths.frame[kept], boxes[kept]
        score = score[kept]
        is_seen = seen != NO_DETECTION
        judged = JudgedBoxes(track, frame, window.time_s[frame], score, on_path[kept], boxes)
        index = np.full(len(seen), NO_DETECTION, np.intp)
        index[is_seen] = window.row[seen[is_seen]]
        order = np.lexsort((track, index, ~is_seen, frame))
        observations = Observations(
            track_id=tracks.ids[track][order],
            frame_index=window.frame_index[frame[order]],
            xyxy_px=boxes[order].astype(np.float32),
            score=score[order].astype(np.float32),
            class_id=class_id[kept][order],
            detection_index=index[order].astype(np.int32),
            trust=judge(features_of(judged))[order].astype(np.float32),
        )
        return _Mended(np.searchsorted(frame[order], np.arange(steps)), observations)


def _in_short_gap(
    seen: NDArray[np.intp], paths: Paths, time_s: NDArray[np.float64], max_gap_s: float
) -> NDArray[np.bool_]:
    """(R,) whether the time between the detections before and after a row of a path is short enough to fill it in.

    A path begins and ends with a detection, so the last one before and the next one after are of the same track."""
    place = np.arange(len(seen))
    is_seen = seen != NO_DETECTION
    before = np.maximum.accumulate(np.where(is_seen, place, 0))
    after = np.minimum.accumulate(np.where(is_seen, place, len(seen) - 1)[::-1])[::-1]
    unseen_s = time_s[paths.frame[after]] - time_s[paths.frame[before]]
    return unseen_s <= max_gap_s * (1 + 1e-9)


def _last_seen(seen: NDArray[np.intp], is_seen: NDArray[np.bool_]) -> NDArray[np.intp]:
    """(R,) the detection of each row, where there is none that of the last row with one: a path begins with one."""
    return seen[np.maximum.accumulate(np.where(is_seen, np.arange(len(is_seen)), 0))]
