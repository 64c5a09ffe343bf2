"""What the pipeline takes and gives.

The result of a run, :class:`LabelledDrive`, holds what is small (tracks, merges, identities) in memory and streams what
is large (observations, labels and 3D boxes) from its artifacts, frame by frame.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Protocol, TypedDict

import numpy as np
from numpy.typing import NDArray

from labeler.errors import HindsightError
from labeler.identity.types import MergeProposal
from labeler.lidar.types import Boxes3D, Positions3D
from labeler.propagation.config import PropagationConfig
from labeler.propagation.types import Donor, Labels
from labeler.tracking.types import Observations


class Cancelled(HindsightError):
    """Raised by a :class:`Progress` to stop a run. What is done so far stays, and the next run resumes from there."""


class Progress(Protocol):
    """Hears what the pipeline does. It may raise :class:`Cancelled` from either call."""

    def stage(self, name: str, units: int) -> None:
        """A stage begins that has this many units of work left to do."""
        ...

    def advance(self, units: int = 1) -> None:
        """Units of the current stage are done."""
        ...


class SilentProgress:
    """Tells nobody."""

    def stage(self, name: str, units: int) -> None:
        pass

    def advance(self, units: int = 1) -> None:
        pass


class CameraSummary(TypedDict):
    """Counts of one camera."""

    frames: int
    detections: int
    tracks: int


class MergeSummary(TypedDict):
    """Counts of merges by state."""

    accepted: int
    proposed: int
    rejected: int


class Summary(TypedDict):
    """What ``hindsight label --json`` prints.

    ``seconds`` is wall time by stage in this run (a stage that was done before takes almost none); ``detector_seconds``
    is the time inside the detector, added up over its threads; ``peak_memory_mb`` is the largest sum of resident memory
    of this process and its workers.
    """

    drive: str
    format: str
    frames: int
    cameras: dict[str, CameraSummary]
    identities: int
    merges: MergeSummary
    labels_propagated: int
    seconds: dict[str, float]
    detector_seconds: float
    peak_memory_mb: float
    warnings: list[str]


@dataclass(frozen=True)
class TrackSummary:
    """One track in a few numbers; ``best_frame`` is the frame of its highest detector score."""

    track_id: int
    camera: str
    first_frame: int
    last_frame: int
    observation_count: int
    best_score: float
    best_frame: int
    class_id: int


@dataclass(frozen=True, eq=False)
class LabelledView:
    """One camera in one frame: ``observations`` and ``labels`` row by row, the 3D boxes of that direction, and where
    its detections stand."""

    observations: Observations
    labels: Labels
    boxes_3d: Boxes3D
    positions: Positions3D = field(default_factory=Positions3D.empty)

    def track_of_boxes_3d(self) -> np.ndarray[tuple[int], np.dtype[np.int32]]:
        """(B,) int32: the track that each 3D box belongs to, through the detection that both come from; -1 for none."""
        tracks = np.full(len(self.boxes_3d), -1, np.int32)
        for row, detection in enumerate(self.boxes_3d.detection_index):
            found = np.flatnonzero(self.observations.detection_index == detection)
            if len(found):
                tracks[row] = self.observations.track_id[found[0]]
        return tracks


@dataclass(frozen=True, eq=False)
class LabelledFrame:
    """All cameras at one frame, by name."""

    frame_index: int
    views: Mapping[str, LabelledView]


@dataclass(frozen=True, eq=False)
class LabelledDrive:
    """The result of a run.

    ``key`` names it: the same sensor data, model and settings give the same key. ``identity_of`` maps every track id to
    its identity, the smallest track id in it; ``donors`` maps an identity to its donor, of any time;
    ``propagation`` is how labels were given. ``open_colours`` reads the colour histogram of every track that merging
    looked at (:mod:`labeler.identity.colours`). ``open_frames`` starts a pass over all frames in order; use
    :meth:`frames`.
    """

    key: str
    class_names: tuple[str, ...]
    tracks: tuple[TrackSummary, ...]
    merges: tuple[MergeProposal, ...]
    identity_of: Mapping[int, int]
    donors: Mapping[int, Donor]
    propagation: PropagationConfig
    summary: Summary
    open_frames: Callable[[], Iterator[LabelledFrame]]
    open_colours: Callable[[], Mapping[int, NDArray[np.float32]]] = dict

    def frames(self) -> Iterator[LabelledFrame]:
        """Every frame with observations in order, read from the artifacts as the caller goes; may be called again."""
        return self.open_frames()

    def observations(self, camera: str) -> Iterator[Observations]:
        """What was seen in one camera, frame by frame."""
        return (frame.views[camera].observations for frame in self.frames() if camera in frame.views)
