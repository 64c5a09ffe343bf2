"""Models by name: those that ship, those that can be pulled, the user's own, and which of them does the work."""

from labeler.models.cache import ModelCache, Record, sha256_of
from labeler.models.choice import (
    NO_SEGMENTATION,
    WITHOUT_WEIGHTS,
    Choice,
    Origin,
    available,
    choose_boxes,
    choose_detector,
    choose_named,
    choose_segmentation,
    notice_of,
)
from labeler.models.download import PullProgress
from labeler.models.errors import ModelStoreError, PullError
from labeler.models.inspection import inspect
from labeler.models.pulling import Pulled, pull
from labeler.models.registry import OFFICIAL, SHIPPED, OfficialModel, ShippedModel, Task
from labeler.models.verification import Verdict, verify

__all__ = [
    "NO_SEGMENTATION",
    "OFFICIAL",
    "SHIPPED",
    "WITHOUT_WEIGHTS",
    "Choice",
    "ModelCache",
    "ModelStoreError",
    "OfficialModel",
    "Origin",
    "PullError",
    "PullProgress",
    "Pulled",
    "Record",
    "ShippedModel",
    "Task",
    "Verdict",
    "available",
    "choose_boxes",
    "choose_detector",
    "choose_named",
    "choose_segmentation",
    "inspect",
    "notice_of",
    "pull",
    "sha256_of",
    "verify",
]
