"""The steps as stages, their settings, artifacts and executors."""

from labeler.pipeline.executors import Executor, open_executor
from labeler.pipeline.run import label_drive
from labeler.pipeline.settings import LabelSettings
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
    "Executor",
    "LabelSettings",
    "LabelledDrive",
    "LabelledFrame",
    "LabelledView",
    "Progress",
    "SilentProgress",
    "Summary",
    "TrackSummary",
    "label_drive",
    "open_executor",
]
