"""Step 4b: which tracks of different cameras are one object, and why: see :func:`propose_merges`."""

from labeler.identity.config import IdentityConfig
from labeler.identity.decide import Merges, propose_merges
from labeler.identity.linking import CannotLinkError, IdentityGraph, SharedFrames, components
from labeler.identity.types import CameraView, MergeProposal, MergeState, MultiCameraFrame, SharedFrame

__all__ = [
    "CameraView",
    "CannotLinkError",
    "IdentityConfig",
    "IdentityGraph",
    "MergeProposal",
    "MergeState",
    "Merges",
    "MultiCameraFrame",
    "SharedFrame",
    "SharedFrames",
    "components",
    "propose_merges",
]
