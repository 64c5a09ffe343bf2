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


@dataclass(frozen=True)
class MergeProposal:
    """A claim that two tracks are one object.

    ``track_a`` < ``track_b`` are track ids of different cameras. ``score`` in 0..1 says how sure the machine is.
    ``shared_frames`` is how many frames have a 3D box of both, ``agreeing_frames`` in how many of them the boxes lie at
    the same place, ``best_frames`` the frames that speak most for the claim (a few, best first). ``reason`` is a
    sentence for a person.
    """

    track_a: int
    camera_a: str
    track_b: int
    camera_b: str
    score: float
    state: MergeState
    shared_frames: int
    agreeing_frames: int
    mean_distance_m: float
    mean_bev_iou: float
    best_frames: tuple[SharedFrame, ...]
    reason: str
