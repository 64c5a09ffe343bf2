"""What the identity step says: which tracks of different cameras are one object, and why."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from labeler.lidar.types import Boxes3D, Positions3D
from labeler.tracking.types import Observations


@dataclass(frozen=True, eq=False)
class CameraView:
    """What one camera contributes to a frame: the tracks' observations, 3D boxes made from its painted points, and
    where its detections stand."""

    observations: Observations
    boxes_3d: Boxes3D
    positions: Positions3D = field(default_factory=Positions3D.empty)


@dataclass(frozen=True, eq=False)
class MultiCameraFrame:
    """All cameras at one frame of the drive, by camera name."""

    frame_index: int
    views: Mapping[str, CameraView]


class MergeState(StrEnum):
    """What became of the claim that two tracks are one object."""

    ACCEPTED = "accepted"
    PROPOSED = "proposed"
    REJECTED = "rejected"


@dataclass(frozen=True)
class SharedFrame:
    """The evidence of one frame in which both tracks have a 3D box.

    ``distance_m`` is between the centres seen from above; ``bev_iou`` and ``iou_3d`` are overlaps of the boxes."""

    frame_index: int
    distance_m: float
    bev_iou: float
    iou_3d: float


class MergeKind(StrEnum):
    """How two tracks could be one object: seen by two cameras at the same time, by two cameras one after the other, or
    in one camera, lost and found again."""

    OVERLAP = "overlap"
    HANDOVER = "handover"
    FRAGMENT = "fragment"


@dataclass(frozen=True)
class Feature:
    """One thing that was measured about two tracks, and what it says: above 0 ``log_odds`` speak for one object."""

    name: str
    value: float
    unit: str
    log_odds: float


@dataclass(frozen=True)
class MergePlot:
    """Both tracks from above, in the ego frame (x forward, y left, metres) of ``reference_frame``.

    ``ego`` rows are frame, x, y, yaw of the recording car; ``track_a`` and ``track_b`` rows are frame, x, y and
    standard deviation of the smoothed trajectories; ``boxes_a`` and ``boxes_b`` rows are frame, x, y, length,
    width, yaw of 3D boxes, at frames that tell most.
    """

    reference_frame: int
    ego: tuple[tuple[float, ...], ...]
    track_a: tuple[tuple[float, ...], ...]
    track_b: tuple[tuple[float, ...], ...]
    boxes_a: tuple[tuple[float, ...], ...]
    boxes_b: tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class MergeEvidence:
    """What a merge's score is made of. Where it is ``calibrated``, the score is a probability: the logistic function of
    ``bias_log_odds`` plus the log odds of all ``features``. ``gap_s`` is the time between the end of the one track and
    the beginning of the other, 0 where both were seen at the same time, and ``gap_frames`` these two frames."""

    kind: MergeKind
    calibrated: bool
    gap_s: float = 0.0
    gap_frames: tuple[int, int] | None = None
    features: tuple[Feature, ...] = ()
    bias_log_odds: float = 0.0
    plot: MergePlot | None = None


@dataclass(frozen=True)
class MergeProposal:
    """A claim that two tracks are one object.

    ``track_a`` < ``track_b`` are track ids. ``score`` in 0..1 says how sure the machine is; a probability where the
    evidence is calibrated. ``shared_frames`` is how many frames have a place in 3D of both, ``agreeing_frames`` in how
    many of them it is the same, ``best_frames`` the frames that speak most for the claim (a few, best first). The means
    are over agreeing frames, None where there are none. ``reason`` is a sentence for a person.
    """

    track_a: int
    camera_a: str
    track_b: int
    camera_b: str
    score: float
    state: MergeState
    shared_frames: int
    agreeing_frames: int
    mean_distance_m: float | None
    mean_bev_iou: float | None
    best_frames: tuple[SharedFrame, ...]
    reason: str
    evidence: MergeEvidence


@dataclass(frozen=True)
class Merges:
    """``proposals`` by descending score, and ``identity_of`` every track: the smallest track id of its identity. What a
    person decided holds in ``identity_of``; the proposal of such a pair has the state that the machine alone gives it.
    """

    proposals: tuple[MergeProposal, ...]
    identity_of: dict[int, int]
