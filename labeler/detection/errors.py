"""What can be wrong with a detector."""

from labeler.inference.errors import ModelError


class DetectionError(ModelError):
    """The file is no YOLOX model, knows none of the classes asked for, or failed while it ran."""
