"""What can go wrong while a model is trained."""

from labeler.errors import HindsightError


class TrainingError(HindsightError):
    """A model can't be trained: the message says why and what to do."""
