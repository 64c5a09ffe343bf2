"""What can go wrong while a drive is recorded from CARLA."""

from labeler.errors import HindsightError


class CarlaError(HindsightError):
    """A drive can't be recorded from CARLA: the message says why and what to do."""
