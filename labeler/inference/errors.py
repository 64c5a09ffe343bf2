"""What can be wrong with a model file."""

from labeler.errors import HindsightError


class ModelError(HindsightError):
    """The model file can't be used, or failed while it ran: the message names the file, says why and what to do."""
