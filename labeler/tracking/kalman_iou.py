"""The paper's tracker: a Kalman filter predicts each box, overlap with the prediction finds its detection.

In each image the tracks' boxes are moved to the image's time, then detections are assigned to them by IoU. Detections
that may begin a track choose first; the weak ones go to tracks that are still without, and begin none. So a weak box
on top of a strong one can't take its track. What is left of the strong detections begins new tracks. An observation is
always a detection: the box that the detector said, never the filtered one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from labeler.tracking.association import associate
from labeler.tracking.config import TrackingConfig
from labeler.tracking.frames import NS_PER_S, with_usable_detections
from labeler.tracking.motion import BoxMotion, TimeStep
from labeler.tracking.types import DetectedFrame, Observations


@dataclass(eq=False)
class _Track:
    """A track that has not ended."""

    track_id: int
    group: int
    last_seen_ns: int
    motion: BoxMotion


class KalmanIouTracker:
    """Follows objects through the images of one camera; see the module for the method.

    ``class_groups[class_id]`` is a number; a track holds only classes of one number. The detector's class of one object
    flickers between car, truck and bus, so these share a number; a person has another one and never continues a car.

    ``rejected_count`` counts detections that could not be used: score or box not finite, or a box without area.
    """

    def __init__(self, config: TrackingConfig, *, class_groups: Sequence[int]) -> None:
        self._config = config
        self._class_groups = np.asarray(class_groups, np.int64)
        self.rejected_count = 0

    def track(self, frames: Iterable[DetectedFrame], *, first_track_id: int) -> Iterator[Observations]:
        """One Observations for each frame, also where it is empty, rows by ``detection_index``.

        Only live tracks and some frames are held in memory. Raises TrackingError where frames come out of order (equal
        timestamps are taken as no time passing) or a class id has no group.
        """
        live: list[_Track] = []
        next_track_id = first_track_id
        previous: DetectedFrame | None = None
        for frame, found in with_usable_detections(
            frames, min_score=self._config.min_score, class_groups=self._class_groups
        ):
            self.rejected_count += found.broken_count
            step = TimeStep.of(_seconds_since(previous, frame))
            live = self._without_ended(live, frame.timestamp_ns)
            for track in live:
                track.motion.predict(step)

            usable = found.rows
            groups = np.full(len(frame.detections), -1, np.int64)
            groups[usable] = found.group
            boxes = frame.detections.xyxy_px.astype(np.float64)
            fed = self._assign(live, usable, frame.detections.score, boxes, groups)
            for row, track in fed.items():
                track.motion.update(boxes[row])
                track.last_seen_ns = frame.timestamp_ns

            for row in usable[frame.detections.score[usable] >= self._config.birth_score].tolist():
                if row not in fed:
                    motion = BoxMotion(boxes[row], self._config)
                    fed[row] = _Track(next_track_id, int(groups[row]), frame.timestamp_ns, motion)
                    live.append(fed[row])
                    next_track_id += 1
            yield _observations(frame, fed)
            previous = frame

    def _without_ended(self, live: list[_Track], timestamp_ns: int) -> list[_Track]:
        max_coast_ns = round(self._config.max_coast_s * NS_PER_S)
        return [track for track in live if timestamp_ns - track.last_seen_ns <= max_coast_ns]

    def _assign(
        self,
        live: list[_Track],
        usable: NDArray[np.intp],
        score: NDArray[np.float32],
        boxes: NDArray[np.float64],
        groups: NDArray[np.int64],
    ) -> dict[int, _Track]:
        """The track that each detection feeds, by row of the detections."""
        strong = score[usable] >= self._config.birth_score
        waiting: list[_Track] = live
        fed: dict[int, _Track] = {}
        for rows in (usable[strong], usable[~strong]):
            if not waiting or not len(rows):
                continue
            tracks, columns = associate(
                np.stack([track.motion.xyxy_px for track in waiting]),
                boxes[rows],
                track_group=np.array([track.group for track in waiting], np.int64),
                detection_group=groups[rows],
                min_iou=self._config.min_iou,
            )
            for track, column in zip(tracks.tolist(), columns.tolist(), strict=True):
                fed[int(rows[column])] = waiting[track]
            taken = set(tracks.tolist())
            waiting = [track for index, track in enumerate(waiting) if index not in taken]
        return fed


def _seconds_since(previous: DetectedFrame | None, frame: DetectedFrame) -> float:
    return 0.0 if previous is None else (frame.timestamp_ns - previous.timestamp_ns) / NS_PER_S


def _observations(frame: DetectedFrame, fed: dict[int, _Track]) -> Observations:
    rows = np.array(sorted(fed), np.intp)
    return Observations(
        track_id=np.array([fed[row].track_id for row in rows.tolist()], np.int32),
        frame_index=np.full(len(rows), frame.frame_index, np.int32),
        xyxy_px=frame.detections.xyxy_px[rows],
        score=frame.detections.score[rows],
        class_id=frame.detections.class_id[rows],
        detection_index=rows.astype(np.int32),
    )
