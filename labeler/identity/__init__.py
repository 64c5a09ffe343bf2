"""Step 4b: which tracks are one object, and why: see :func:`find_merges`."""

from labeler.identity.config import Algorithm2Config, IdentityConfig
from labeler.identity.constraints import Decisions, TrackAnchor
from labeler.identity.finding import find_merges
from labeler.identity.linking import CannotLinkError, IdentityGraph, SharedFrames, components
from labeler.identity.rig import Rig
from labeler.identity.types import (
    CameraView,
    Feature,
    MergeEvidence,
    MergeKind,
    MergePlot,
    MergeProposal,
    Merges,
    MergeState,
    MultiCameraFrame,
    SharedFrame,
)

__all__ = [
    "Algorithm2Config",
    "CameraView",
    "CannotLinkError",
    "Decisions",
    "Feature",
    "IdentityConfig",
    "IdentityGraph",
    "MergeEvidence",
    "MergeKind",
    "MergePlot",
    "MergeProposal",
    "MergeState",
    "Merges",
    "MultiCameraFrame",
    "Rig",
    "SharedFrame",
    "SharedFrames",
    "TrackAnchor",
    "components",
    "find_merges",
]
