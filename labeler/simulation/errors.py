"""What can go wrong while a drive is simulated."""

from labeler.errors import HindsightError


class SimulationError(HindsightError):
    """A drive can't be simulated: the message says why and what to do."""
