"""What can be wrong with the input of the propagation step."""

from labeler.errors import HindsightError


class PropagationError(HindsightError):
    """The settings make no sense: the message says why and what to do."""
