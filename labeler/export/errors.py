"""What can go wrong when a dataset is written."""

from labeler.errors import HindsightError


class ExportError(HindsightError):
    """The dataset can't be written: the message says why and what to do."""
