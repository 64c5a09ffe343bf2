"""What a person has decided about tracks, as constraints on a run of the pipeline.

Track numbers change when settings do, so a decision names a track by some of its boxes (:class:`TrackAnchor`). The
track of that camera whose boxes overlap most of these is the same object in the new run.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import median

import numpy as np

from labeler.geometry.boxes_2d import iou_matrix
from labeler.tracking.types import Observations

MIN_IOU = 0.5
_MIN_SHARE_OF_FRAMES = 0.5

Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class TrackAnchor:
    """Some observations of a track, enough to find it again: ``xyxy_px`` are its boxes in the frames ``frame_index`` of
    ``camera``. One is enough; several, spread over the track, tell tracks that cross each other apart."""

    camera: str
    frame_index: tuple[int, ...]
    xyxy_px: tuple[Box, ...]

    def __post_init__(self) -> None:
        if len(self.frame_index) != len(self.xyxy_px) or not self.frame_index:
            raise ValueError(
                f"TrackAnchor needs a box for each of at least one frame, got {len(self.frame_index)} frames and "
                f"{len(self.xyxy_px)} boxes"
            )


@dataclass(frozen=True)
class Decisions:
    """All that holds: pairs of tracks that are one object (``same``) or are not (``different``). What can't be placed
    in a run, or contradicts that two tracks of a camera stand in one frame, has no effect there."""

    same: tuple[tuple[TrackAnchor, TrackAnchor], ...] = ()
    different: tuple[tuple[TrackAnchor, TrackAnchor], ...] = ()


class AnchorFinder:
    """Finds the tracks that anchors mean, while the observations of a drive stream by."""

    def __init__(self, anchors: Iterable[TrackAnchor]) -> None:
        self._overlaps: dict[TrackAnchor, dict[int, list[float]]] = {anchor: {} for anchor in anchors}
        self._seen_frames: dict[TrackAnchor, int] = dict.fromkeys(self._overlaps, 0)
        self._wanted: dict[tuple[str, int], list[tuple[TrackAnchor, Box]]] = {}
        for anchor in self._overlaps:
            for frame_index, box in zip(anchor.frame_index, anchor.xyxy_px, strict=True):
                self._wanted.setdefault((anchor.camera, frame_index), []).append((anchor, box))

    def add(self, camera: str, frame_index: int, observations: Observations) -> None:
        """Look at the observations of one image."""
        for anchor, box in self._wanted.get((camera, frame_index), ()):
            if not len(observations):
                continue
            self._seen_frames[anchor] += 1
            overlap = iou_matrix(np.array([box]), observations.xyxy_px.astype(np.float64))[0]
            best = int(overlap.argmax())
            if overlap[best] >= MIN_IOU:
                track = int(observations.track_id[best])
                self._overlaps[anchor].setdefault(track, []).append(float(overlap[best]))

    def track_of(self, anchor: TrackAnchor) -> int | None:
        """The track that lies on most of an anchor's boxes, of equals the one that overlaps them more. None where none
        lies on at least half of those in images in which anything was seen."""
        found = self._overlaps[anchor]
        if not found:
            return None
        best = max(found, key=lambda track: (len(found[track]), median(found[track]), -track))
        return best if len(found[best]) >= _MIN_SHARE_OF_FRAMES * self._seen_frames[anchor] else None


@dataclass(frozen=True)
class Constraints:
    """Decisions in terms of the tracks of a run."""

    same: tuple[tuple[int, int], ...] = ()
    different: tuple[tuple[int, int], ...] = ()

    @staticmethod
    def of(decisions: Decisions, finder: AnchorFinder) -> Constraints:
        """Those of which both tracks were found and differ; ``finder`` has seen all observations. Of pairs that are
        said to be both, as where a person cut a track that is whole in this run, nothing is known."""
        same, different = _placed(decisions.same, finder), _placed(decisions.different, finder)
        contrary = {*same} & {*different}
        return Constraints(
            tuple(pair for pair in same if pair not in contrary),
            tuple(pair for pair in different if pair not in contrary),
        )


def merge_anchors(decisions: Decisions) -> list[TrackAnchor]:
    """The anchors of decisions about pairs of tracks."""
    return [anchor for pair in (*decisions.same, *decisions.different) for anchor in pair]


def _placed(pairs: Sequence[tuple[TrackAnchor, TrackAnchor]], finder: AnchorFinder) -> tuple[tuple[int, int], ...]:
    placed = [(finder.track_of(a), finder.track_of(b)) for a, b in pairs]
    found = [(min(a, b), max(a, b)) for a, b in placed if a is not None and b is not None and a != b]
    return tuple(dict.fromkeys(found))
