"""What can be wrong with a segmentation."""

from labeler.inference.errors import ModelError


class SegmentationError(ModelError):
    """The file is no segmentation model, its metadata can't be read, or it failed while it ran."""
