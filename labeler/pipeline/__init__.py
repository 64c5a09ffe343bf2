"""The steps as stages, their settings, artifacts and executors."""

from labeler.pipeline.types import (
    Cancelled,
    LabelledDrive,
    LabelledFrame,
    LabelledView,
    Progress,
    SilentProgress,
    Summary,
    TrackSummary,
)

__all__ = [
    "Cancelled",
    "LabelledDrive",
    "LabelledFrame",
    "LabelledView",
    "Progress",
    "SilentProgress",
    "Summary",
    "TrackSummary",
]
